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
    view_.sh_degree = cloud.view.sh_degree, view_.include = include_.data();
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
    std::vector<DeviceBuffer<Launcher, float>> own(out.size());  // of planes that are not resident
    std::vector<Plane<float>> planes;
    for (std::size_t c = 0; c < out.size(); ++c) planes.push_back(on_device(out[c], own[c]));
    splat_.forward(planes, for_backward);
    std::vector<float> host;
    for (std::size_t c = 0; c < out.size(); ++c) {
      if (own[c].size() == 0) continue;
      own[c].to(host);
      for (std::size_t i = 0; i < host.size(); ++i) out[c].data[i * std::size_t(out[c].stride)] = host[i];
    }
  }

  void backward(const std::vector<Plane<const float>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<float>& out) override {
    std::vector<DeviceBuffer<Launcher, float>> own(grad.size());
    std::vector<Plane<const float>> planes;
    std::vector<float> host(static_cast<std::size_t>(pixels_));
    for (std::size_t c = 0; c < grad.size(); ++c) {
      const Plane<float> plane = on_device(grad[c], own[c]);
      planes.push_back({plane.data, plane.stride});
      if (own[c].size() == 0) continue;
      for (std::size_t i = 0; i < host.size(); ++i) host[i] = grad[c].data[i * std::size_t(grad[c].stride)];
      launcher_.upload(own[c].data(), host.data(), host.size() * sizeof(float));
    }
    const CloudView<float>& cloud = cloud_.view();
    Columns columns(launcher_, cloud, plan_.labels(), out);
    splat_.backward(planes, moves, columns.view, sums_);
    columns.download(out);
  }

 private:
  /// The plane in device memory: of a resident image, or in memory of its own.
  template <class T>
  Plane<float> on_device(const Plane<T>& host, DeviceBuffer<Launcher, float>& own) {
    if (host.data == nullptr) return {nullptr, 1};
    const std::size_t values = std::size_t(pixels_ - 1) * std::size_t(host.stride) + 1;
    if (void* const resident = launcher_.resident.find(host.data, values * sizeof(float)))
      return {static_cast<float*>(resident), host.stride};
    own = {launcher_, pixels_};
    return {own.data(), 1};
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
      make(position, wanted.position, view.position, 3), make(rotation, wanted.rotation, view.rotation, 4);
      make(log_scale, wanted.log_scale, view.log_scale, 3);
      make(logit_opacity, wanted.logit_opacity, view.logit_opacity, 1);
      make(sh_dc, wanted.sh_dc, view.sh_dc, 3), make(sh_rest, wanted.sh_rest, view.sh_rest, cloud.rest_stride * 3);
      make(label, wanted.label, view.label, labels), make(mean_px, wanted.mean_px, view.mean_px, 2);
      make(visible, wanted.visible, view.visible, 1);
      if (wanted.label_only)
        label_only = {launcher, wanted.label_only, cloud.size}, view.label_only = label_only.data();
      if (wanted.gradient_row)
        gradient_row = {launcher, wanted.gradient_row, cloud.size}, view.gradient_row = gradient_row.data(),
        view.rows = rows;
    }
    void download(const CloudGradientView<float>& to) const {
      position.to(to.position), rotation.to(to.rotation), log_scale.to(to.log_scale),
          logit_opacity.to(to.logit_opacity);
      sh_dc.to(to.sh_dc), sh_rest.to(to.sh_rest), label.to(to.label), mean_px.to(to.mean_px), visible.to(to.visible);
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

  ViewSums evidence(const ViewProjector<float>& view, const CloudOnHost& cloud, const ViewMasks& masks,
                    bool by_visibility) const override {
    const CloudArgument<Launcher> columns(launcher_, cloud, false);
    const TileBins<Launcher> bins(launcher_, view, columns.view());
    const int objects = int(masks.target.size());
    const DeviceBuffer<Launcher, std::uint8_t> known(launcher_, masks.known);
    const PixelWindow window = window_of(masks.target, masks.width_px, masks.height_px, 0);
    std::vector<float> inside;  // [objects, window]
    for (const std::vector<float>& target : masks.target) {
      const std::vector<float> part = cropped(target, masks.width_px, 1, window);
      inside.insert(inside.end(), part.begin(), part.end());
    }
    const DeviceBuffer<Launcher, float> target(launcher_, inside);
    const SeenRows<Launcher> seen(launcher_, bins, {known.data(), target.data(), window, objects, by_visibility});
    ViewSums sums{objects, true, {}, {}};
    seen.row.to(sums.row), seen.sum.to(sums.sum);
    return sums;
  }

 private:
  Launcher& launcher_;
  DeviceSums sums_;
};

}  // namespace ngs
