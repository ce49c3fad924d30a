#pragma once
// Forward and backward pass of one view on a device: the counterpart of SplatEngine on the CPU.
#include <memory>

#include "ngs/ops/device/splat_backward_kernel.h"

namespace ngs {

/// A device copy of the columns of a cloud. Colours are copied when they are first needed.
template <class Launcher>
class CloudOnDevice {
  template <class T>
  using Column = DeviceBuffer<Launcher, T>;

 public:
  CloudOnDevice(Launcher& launcher, const CloudView<float>& cloud)
      : launcher_(launcher),
        host_(cloud),
        position_(launcher, cloud.position, cloud.size * 3),
        rotation_(launcher, cloud.rotation, cloud.size * 4),
        log_scale_(launcher, cloud.log_scale, cloud.size * 3),
        logit_opacity_(launcher, cloud.logit_opacity, cloud.size),
        usable_(launcher, cloud.usable, cloud.usable ? cloud.size : 0) {}

  /// Device pointers; null: colours without `colours`, and `include`.
  CloudView<float> view(bool colours) {
    if (colours && sh_dc_.data() == nullptr) {
      sh_dc_ = Column<float>(launcher_, host_.sh_dc, host_.size * 3);
      sh_rest_ = Column<float>(launcher_, host_.sh_rest, host_.size * host_.rest_stride * 3);
    }
    CloudView<float> view = host_;
    view.position = position_.data();
    view.rotation = rotation_.data();
    view.log_scale = log_scale_.data();
    view.logit_opacity = logit_opacity_.data();
    view.usable = usable_.data();
    view.include = nullptr;
    view.sh_dc = colours ? sh_dc_.data() : nullptr;
    view.sh_rest = colours ? sh_rest_.data() : nullptr;
    return view;
  }

 private:
  Launcher& launcher_;
  CloudView<float> host_;
  Column<float> position_, rotation_, log_scale_, logit_opacity_, sh_dc_, sh_rest_;
  Column<std::uint8_t> usable_;
};

struct GaussiansBackward {
  static constexpr const char* kName = "gaussians_backward";
  GaussianBackward<float> kernel;  // its rows are sums over the tiles of a Gaussian
  const std::int64_t* slot_begin;
  const float* channel;  // [N, count]
  NGS_HD void operator()(std::int64_t i) const {
    if (const std::int64_t to = kernel.out.gradient_row ? kernel.out.gradient_row[i] : i; to >= 0) clear(to);
    if (slot_begin[i] < slot_begin[i + 1]) kernel.gather(i, channel + i * kernel.plan.count(), i, i + 1);
  }
  NGS_HD void clear(std::int64_t to) const {
    const auto zero = [to](auto* column, int width) {
      for (int k = 0; column && k < width; ++k) column[to * width + k] = 0;
    };
    const CloudGradientView<float>& out = kernel.out;
    zero(out.position, 3);
    zero(out.rotation, 4);
    zero(out.log_scale, 3);
    zero(out.logit_opacity, 1);
    zero(out.sh_dc, 3);
    zero(out.sh_rest, kernel.cloud.rest_stride * 3);
    zero(out.label, kernel.plan.labels());
    zero(out.mean_px, 2);
    zero(out.visible, 1);
  }
};

inline constexpr int kMaxChannels = 8;  // in one launch

/// One view. All pointers are device pointers; `cloud` and `plan.label` must outlive it.
template <class Launcher>
class SplatOnDevice {
 public:
  SplatOnDevice(Launcher& launcher, const ViewProjector<float>& view, const CloudView<float>& cloud,
                const ChannelPlan<float>& plan)
      : launcher_(launcher),
        projector_(view),
        cloud_(cloud),
        plan_(plan),
        channel_(launcher, cloud.size * plan.count()),
        bins_(launcher, view, cloud, {plan, channel_.data()}) {}

  /// out[c]: channel c; out[count]: 1 - T_final. `for_backward`: backward() will follow.
  void forward(const std::vector<Plane<float>>& out, bool for_backward) {
    if (for_backward) {
      checkpoint_ = {launcher_, Checkpoints::rows(bins_.pairs(), bins_.tiles()) * std::int64_t(kTilePixels)};
      checkpoint_count_ = {launcher_, bins_.tiles()};
    }
    for (int first = 0; first == 0 || first < plan_.count(); first += kMaxChannels)
      with_group(first, [&](auto size) {
        SplatForwardTile<size> kernel{bins_.view(), group<size>(first), {}, {}, {}};
        for (int c = 0; c < kernel.channels.used; ++c) kernel.out[c] = out[std::size_t(first + c)];
        if (first == 0) {
          kernel.alpha = out[std::size_t(plan_.count())];
          kernel.checkpoints = checkpoints();
        }
        launcher_.launch_blocks(bins_.tiles(), kernel);
      });
  }

  /// Like SplatEngine::backward. The columns of `out` are overwritten.
  void backward(const std::vector<Plane<const float>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<float>& out, DeviceSums sums) {
    const int columns = kPairGeometry + plan_.count();
    DeviceBuffer<Launcher, float> rows(launcher_,
                                       (sums == DeviceSums::kAtomic ? cloud_.size : bins_.pairs()) * columns);
    rows.zero();
    for (int first = 0; first == 0 || first < plan_.count(); first += kMaxChannels)
      with_group(first, [&](auto size) {
        SplatBackwardTile<size, Launcher> kernel{bins_.view(),  group<size>(first), {},      0,
                                                 checkpoints(), rows.data(),        columns, sums};
        for (int c = 0; c < kernel.channels.used; ++c) {
          kernel.grad[c] = grad[std::size_t(first + c)];
          if (moves[std::size_t(first + c)]) kernel.moves |= 1u << c;
        }
        if (first == 0) kernel.grad[size] = grad[std::size_t(plan_.count())];
        launcher_.launch_blocks(bins_.tiles(), kernel);
      });
    if (sums == DeviceSums::kInOrder) {
      DeviceBuffer<Launcher, float> sum(launcher_, cloud_.size * columns);
      launcher_.parallel_for(sum.size(), SumPairColumns<float>{bins_.slot_begin(), rows.data(), columns, sum.data()});
      rows = std::move(sum);
    }
    launcher_.parallel_for(cloud_.size,
                           GaussiansBackward{{projector_, cloud_, plan_, {rows.data(), cloud_.size, columns}, out},
                                             bins_.slot_begin(),
                                             channel_.data()});
  }

  const TileBins<Launcher>& bins() const { return bins_; }

 private:
  Checkpoints checkpoints() const { return {checkpoint_.data(), checkpoint_count_.data()}; }
  /// body(std::integral_constant<int, C>) for the C that holds the channels from `first` on.
  template <class Body>
  void with_group(int first, const Body& body) const {
    switch (plan_.count() - first) {
      case 0:
      case 1: return body(std::integral_constant<int, 1>{});
      case 3: return body(std::integral_constant<int, 3>{});
      case 4: return body(std::integral_constant<int, 4>{});
      case 5: return body(std::integral_constant<int, 5>{});
      default: return body(std::integral_constant<int, kMaxChannels>{});
    }
  }
  template <int C>
  ChannelGroup<C> group(int first) const {
    ChannelGroup<C> g{channel_.data(), plan_.count(), first, min2(C, plan_.count() - first), {}};
    const float b[3] = {plan_.background.x, plan_.background.y, plan_.background.z};
    if (plan_.colour && first == 0)
      for (int c = 0; c < min2(C, 3); ++c) g.background[c] = b[c];
    return g;
  }
  Launcher& launcher_;
  ViewProjector<float> projector_;
  CloudView<float> cloud_;
  ChannelPlan<float> plan_;
  DeviceBuffer<Launcher, float> channel_;  // [N, count]
  TileBins<Launcher> bins_;
  DeviceBuffer<Launcher, float> checkpoint_;
  DeviceBuffer<Launcher, std::int32_t> checkpoint_count_;
};

}  // namespace ngs
