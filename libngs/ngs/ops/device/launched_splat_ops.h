#pragma once
// DeviceSplatOps on a Launcher: uploads, runs the kernels, downloads.
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/device/evidence_kernel.h"
#include "ngs/ops/device/splat_kernel.h"

namespace ngs {

template <class Launcher>
class ResidentCloud final : public DeviceCloud {
 public:
  ResidentCloud(Launcher& launcher, const CloudView<float>& cloud) : columns(launcher, cloud) {}
  CloudOnDevice<Launcher> columns;
};

/// A cloud as the argument of a view: the resident columns, or a copy.
template <class Launcher>
class CloudArgument {
 public:
  CloudArgument(Launcher& launcher, const CloudOnHost& cloud, bool colours)
      : include_(launcher, cloud.view.include, cloud.view.include ? cloud.view.size : 0) {
    if (cloud.resident == nullptr) own_ = std::make_unique<CloudOnDevice<Launcher>>(launcher, cloud.view);
    view_ = (own_ ? *own_ : static_cast<ResidentCloud<Launcher>*>(cloud.resident)->columns).view(colours);
    view_.sh_degree = cloud.view.sh_degree;
    view_.include = include_.data();
  }
  const CloudView<float>& view() const { return view_; }

 private:
  std::unique_ptr<CloudOnDevice<Launcher>> own_;
  DeviceBuffer<Launcher, std::uint8_t> include_;
  CloudView<float> view_;
};

template <class Launcher>
class LaunchedSplatView final : public DeviceSplat {
 public:
  LaunchedSplatView(Launcher& launcher, DeviceSums sums, const ViewProjector<float>& view, const CloudOnHost& cloud,
                    const ChannelPlan<float>& plan)
      : launcher_(launcher),
        sums_(sums),
        plan_(plan),
        pixels_(std::int64_t(view.width_px) * view.height_px),
        cloud_(launcher, cloud, plan.colour),
        label_(launcher, plan.label.data, plan.label.n * plan.label.c),
        splat_(launcher, view, cloud_.view(),
               {plan.colour, plan.depth, {label_.data(), plan.label.n, plan.label.c}, plan.background}) {}

  void forward(const std::vector<Plane<float>>& out, bool for_backward) override {
    std::vector<Image> images;
    std::vector<Plane<float>> planes;
    for_each_image(out, [&](const Plane<float>& first) {
      images.push_back(Image::result(launcher_, first.data, pixels_ * first.stride));
      add_planes(images.back(), first.stride, planes);
    });
    splat_.forward(planes, for_backward);
    auto image = images.begin();
    for_each_image(out, [&](const Plane<float>& first) { (image++)->to(first.data); });
  }

  void backward(const std::vector<Plane<const float>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<float>& out) override {
    std::vector<Image> images;
    std::vector<Plane<const float>> planes;
    for_each_image(grad, [&](const Plane<const float>& first) {
      images.emplace_back(launcher_, first.data, first.data ? pixels_ * first.stride : 0);
      add_planes(images.back(), first.stride, planes);
    });
    const CloudView<float>& cloud = cloud_.view();
    Columns columns(launcher_, cloud, plan_.labels(), out);
    splat_.backward(planes, moves, columns.view, sums_);
    columns.download(out);
  }

 private:
  using Image = DeviceBuffer<Launcher, float>;  // [H, W, channels] as on the host
  /// Calls f with the first plane of each image; the stride of a plane is the number of planes of its image.
  template <class T, class F>
  static void for_each_image(const std::vector<Plane<T>>& planes, const F& f) {
    for (std::size_t c = 0; c < planes.size(); c += std::size_t(planes[c].stride)) f(planes[c]);
  }
  template <class T>
  static void add_planes(const Image& image, int channels, std::vector<Plane<T>>& planes) {
    for (int c = 0; c < channels; ++c) planes.push_back({image.data() ? image.data() + c : nullptr, channels});
  }
  /// The requested columns of the gradient.
  struct Columns {
    DeviceBuffer<Launcher, float> position, rotation, log_scale, logit_opacity, sh_dc, sh_rest, label, mean_px;
    DeviceBuffer<Launcher, std::uint8_t> visible, label_only;
    DeviceBuffer<Launcher, std::int32_t> gradient_row;
    CloudGradientView<float> view;

    Columns(Launcher& launcher, const CloudView<float>& cloud, int labels, const CloudGradientView<float>& wanted) {
      const std::int64_t rows = wanted.gradient_row ? wanted.rows : cloud.size;
      const auto make = [&](auto& buffer, auto* host, auto*& pointer, int width) {
        if (host == nullptr || width == 0) return;
        buffer = buffer.result(launcher, host, rows * width);
        pointer = buffer.data();
      };
      make(position, wanted.position, view.position, 3);
      make(rotation, wanted.rotation, view.rotation, 4);
      make(log_scale, wanted.log_scale, view.log_scale, 3);
      make(logit_opacity, wanted.logit_opacity, view.logit_opacity, 1);
      make(sh_dc, wanted.sh_dc, view.sh_dc, 3);
      make(sh_rest, wanted.sh_rest, view.sh_rest, cloud.rest_stride * 3);
      make(label, wanted.label, view.label, labels);
      make(mean_px, wanted.mean_px, view.mean_px, 2);
      make(visible, wanted.visible, view.visible, 1);
      if (wanted.label_only) {
        label_only = {launcher, wanted.label_only, cloud.size};
        view.label_only = label_only.data();
      }
      if (wanted.gradient_row) {
        gradient_row = {launcher, wanted.gradient_row, cloud.size};
        view.gradient_row = gradient_row.data();
        view.rows = rows;
      }
    }
    void download(const CloudGradientView<float>& to) const {
      position.to(to.position);
      rotation.to(to.rotation);
      log_scale.to(to.log_scale);
      logit_opacity.to(to.logit_opacity);
      sh_dc.to(to.sh_dc);
      sh_rest.to(to.sh_rest);
      label.to(to.label);
      mean_px.to(to.mean_px);
      visible.to(to.visible);
    }
  };

  Launcher& launcher_;
  DeviceSums sums_;
  ChannelPlan<float> plan_;
  std::int64_t pixels_;
  CloudArgument<Launcher> cloud_;
  DeviceBuffer<Launcher, float> label_;
  SplatOnDevice<Launcher> splat_;
};

/// The sums of the Gaussians of a view. `limit` [H·W]: only what lies in front of this surface; null: all.
template <class Launcher>
class SumsOfView {
 public:
  SumsOfView(Launcher& launcher, const TileBins<Launcher>& bins, const ViewMasks& masks, bool by_visibility,
             const float* limit = nullptr)
      : bins_(bins), columns_(2 + 2 * int(masks.target.size())), sum_(launcher, bins.gaussians() * columns_) {
    const int objects = int(masks.target.size());
    const DeviceBuffer<Launcher, std::uint8_t> known(launcher, masks.known);
    const PixelWindow window = window_of(masks.target, masks.width_px, masks.height_px, 0);
    std::vector<float> inside;  // [objects, window]
    for (const std::vector<float>& target : masks.target) {
      const std::vector<float> part = cropped(target, masks.width_px, 1, window);
      inside.insert(inside.end(), part.begin(), part.end());
    }
    const DeviceBuffer<Launcher, float> target(launcher, inside);
    DeviceBuffer<Launcher, float> pair(launcher, bins.pairs() * columns_);
    pair.zero();
    const auto add = [&](auto kernel, int first, int most) {
      kernel.tiles = bins.view();
      kernel.masks = {known.data(), target.data(), window, objects, by_visibility};
      kernel.first = first;
      kernel.used = min2(most, objects - first);
      kernel.pair = pair.data();
      kernel.columns = columns_;
      kernel.limit = limit;
      launcher.launch_blocks(bins.tiles(), kernel);
    };
    constexpr int kGroup = 4;
    if (limit != nullptr)
      add(EvidenceTileOnDevice<1, true>{}, 0, 1);
    else if (objects == 1)
      add(EvidenceTileOnDevice<1>{}, 0, 1);
    else
      for (int first = 0; first < max2(objects, 1); first += kGroup) add(EvidenceTileOnDevice<kGroup>{}, first, kGroup);
    launcher.parallel_for(sum_.size(), SumPairColumns<double>{bins.slot_begin(), pair.data(), columns_, sum_.data()});
  }
  PairSums sums() const { return {bins_.slot_begin(), sum_.data(), columns_}; }

  /// The Gaussians with W > 0, ascending, of `wanted` [N], null: of all. Waits for their number, to allocate memory.
  ViewSums seen(Launcher& launcher, const std::uint8_t* wanted) const {
    const std::int64_t n = bins_.gaussians();
    const DeviceBuffer<Launcher, std::uint8_t> flags(launcher, wanted, wanted ? n : 0);
    const DeviceBuffer<Launcher, std::uint32_t> seen(launcher, n);
    const DeviceBuffer<Launcher, std::int64_t> place(launcher, n + 1);
    launcher.parallel_for(n, FindSeen{sums(), flags.data(), seen.data()});
    launcher.exclusive_scan(seen.data(), place.data(), n);
    std::int64_t rows = 0;
    launcher.download(&rows, place.data() + n, sizeof rows);
    const DeviceBuffer<Launcher, std::uint32_t> row(launcher, rows);
    const DeviceBuffer<Launcher, double> sum(launcher, rows * columns_);
    launcher.parallel_for(n, GatherSeen{place.data(), sums(), row.data(), sum.data()});
    ViewSums out{columns_ / 2 - 1, true, {}, {}};
    row.to(out.row);
    sum.to(out.sum);
    return out;
  }

 private:
  const TileBins<Launcher>& bins_;
  int columns_;
  DeviceBuffer<Launcher, double> sum_;  // [N, columns]
};

template <class Launcher>
TileBins<Launcher> bins_of(Launcher& launcher, const ViewProjector<float>& view, const CloudOnHost& cloud) {
  return {launcher, view, CloudArgument<Launcher>(launcher, cloud, false).view()};
}

template <class Launcher>
class LaunchedFrontView final : public DeviceFrontView {
  using Floats = DeviceBuffer<Launcher, float>;

 public:
  LaunchedFrontView(Launcher& launcher, const ViewProjector<float>& view, const CloudOnHost& cloud, const ImageF& limit)
      : launcher_(launcher),
        width_px_(view.width_px),
        height_px_(view.height_px),
        bins_(bins_of(launcher, view, cloud)),
        limit_(launcher, limit.data) {}

  void layer(const std::uint8_t* candidate, const std::uint32_t* number, const Matrix<const float>& value,
             ImageF& out) const override {
    const std::int64_t n = bins_.gaussians();
    const int count = out.channels;
    const DeviceBuffer<Launcher, std::uint8_t> candidates(launcher_, candidate, n);
    const DeviceBuffer<Launcher, std::uint32_t> numbers(launcher_, number, number ? n : 0);
    const Floats values(launcher_, value.data, value.n * value.c), channel(launcher_, n * count);
    launcher_.parallel_for(n, FillLayer{candidates.data(), numbers.data(), values.data(), value.c, channel.data()});
    const Floats image(launcher_, out.pixels() * count);
    const auto composite = [&](auto size, int first) {
      constexpr int kSize = decltype(size)::value;
      const int used = min2(kSize, count - first);
      SplatForwardTile<kSize, true> kernel{bins_.view(), {channel.data(), count, first, used, {}}, {}, {}, {},
                                           limit_.data()};
      for (int c = 0; c < used; ++c) kernel.out[c] = {image.data() + first + c, count};
      launcher_.launch_blocks(bins_.tiles(), kernel);
    };
    constexpr int kGroup = 5;  // colour, share of candidates with a colour, weight
    if (count == 1) composite(std::integral_constant<int, 1>{}, 0);
    for (int first = 0; count > 1 && first < count; first += kGroup)
      composite(std::integral_constant<int, kGroup>{}, first);
    image.to(out.data);
  }

  ViewSums sums(const std::uint8_t* candidate, const std::vector<std::uint8_t>& marked) const override {
    const ViewMasks masks{width_px_, height_px_, {{marked.begin(), marked.end()}}, {}, true};
    return SumsOfView<Launcher>(launcher_, bins_, masks, false, limit_.data()).seen(launcher_, candidate);
  }

 private:
  Launcher& launcher_;
  int width_px_, height_px_;
  TileBins<Launcher> bins_;
  Floats limit_;
};

template <class Launcher>
class LaunchedEvidence final : public DeviceEvidence {
 public:
  LaunchedEvidence(Launcher& launcher, std::int64_t gaussians, int objects)
      : launcher_(launcher),
        objects_(objects),
        whole_(launcher, gaussians),
        fraction_(launcher, gaussians),
        pixels_(launcher, gaussians),
        views_(launcher, gaussians),
        object_(launcher, gaussians * objects),
        touched_(launcher, gaussians * objects) {
    whole_.zero();
    fraction_.zero();
    pixels_.zero();
    views_.zero();
    object_.zero();
    touched_.zero();
  }
  void add(const EvidenceCall& call) override {
    const TileBins<Launcher> bins = bins_of(launcher_, call.view, call.cloud);
    const SumsOfView<Launcher> of_view(launcher_, bins, call.masks, call.by_visibility);
    launcher_.parallel_for(views_.size(), AddPairs{of_view.sums(),
                                                   {whole_.data(), fraction_.data(), pixels_.data(), views_.data(),
                                                    object_.data(), touched_.data()}});
  }
  void download(Evidence& out) const override {
    whole_.to(out.weight.whole);
    fraction_.to(out.weight.fraction);
    pixels_.to(out.pixels);
    views_.to(out.views);
    const std::int64_t cells = touched_.size();
    const DeviceBuffer<Launcher, std::int64_t> place(launcher_, cells + 1);
    launcher_.exclusive_scan(touched_.data(), place.data(), cells);
    std::int64_t count = 0;
    launcher_.download(&count, place.data() + cells, sizeof count);
    const DeviceBuffer<Launcher, SparseTable<ObjectSums>::Insert> gathered(launcher_, count);
    launcher_.parallel_for(cells, GatherTouched{place.data(), object_.data(), objects_, gathered.data()});
    Evidence::DeferredInserts inserts;
    gathered.to(inserts);
    out.object_weights.add(inserts);
  }

 private:
  Launcher& launcher_;
  int objects_;
  DeviceBuffer<Launcher, std::uint64_t> whole_, fraction_, pixels_;  // EvidenceColumns
  DeviceBuffer<Launcher, std::uint32_t> views_;
  DeviceBuffer<Launcher, ObjectSums> object_;
  DeviceBuffer<Launcher, std::uint32_t> touched_;
};

template <class Launcher>
class LaunchedSplatOps final : public DeviceSplatOps {
 public:
  LaunchedSplatOps(Launcher& launcher, DeviceSums sums) : launcher_(launcher), sums_(sums) {}

  std::unique_ptr<DeviceCloud> resident(const CloudView<float>& cloud) const override {
    return std::make_unique<ResidentCloud<Launcher>>(launcher_, cloud);
  }

  std::unique_ptr<DeviceSplat> view(const ViewProjector<float>& view, const CloudOnHost& cloud,
                                    const ChannelPlan<float>& plan) const override {
    return std::make_unique<LaunchedSplatView<Launcher>>(launcher_, sums_, view, cloud, plan);
  }

  ViewSums evidence(const EvidenceCall& call) const override {
    const TileBins<Launcher> bins = bins_of(launcher_, call.view, call.cloud);
    return SumsOfView<Launcher>(launcher_, bins, call.masks, call.by_visibility).seen(launcher_, call.wanted);
  }
  std::unique_ptr<DeviceFrontView> front_view(const ViewProjector<float>& view, const CloudOnHost& cloud,
                                              const ImageF& limit) const override {
    return std::make_unique<LaunchedFrontView<Launcher>>(launcher_, view, cloud, limit);
  }
  std::unique_ptr<DeviceEvidence> evidence_sum(std::int64_t gaussians, int objects) const override {
    return std::make_unique<LaunchedEvidence<Launcher>>(launcher_, gaussians, objects);
  }

 private:
  Launcher& launcher_;
  DeviceSums sums_;
};

}  // namespace ngs
