#pragma once
// DeviceSplatOps on a Launcher: uploads, runs the kernels, downloads.
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/device/evidence_kernel.h"
#include "ngs/ops/device/splat_kernel.h"

namespace ngs {

template <class Launcher>
class LaunchedSplatView final : public DeviceSplat {
 public:
  LaunchedSplatView(Launcher& launcher, DeviceSums sums, const ViewProjector<float>& view,
                    const CloudView<float>& cloud, const ChannelPlan<float>& plan)
      : launcher_(launcher),
        sums_(sums),
        plan_(plan),
        pixels_(std::int64_t(view.width_px) * view.height_px),
        cloud_(launcher, cloud),
        label_(launcher, plan.label.data, plan.label.n * plan.label.c),
        splat_(launcher, view, cloud_.view(),
               {plan.colour, plan.depth, {label_.data(), plan.label.n, plan.label.c}, plan.background}) {}

  void forward(const std::vector<Plane<float>>& out) override {
    const DeviceBuffer<Launcher, float> image(launcher_, std::int64_t(out.size()) * pixels_);
    std::vector<Plane<float>> planes;
    for (std::size_t c = 0; c < out.size(); ++c)
      planes.push_back({out[c].data ? image.data() + std::int64_t(c) * pixels_ : nullptr, 1});
    splat_.forward(planes);
    std::vector<float> host(static_cast<std::size_t>(pixels_));
    for (std::size_t c = 0; c < out.size(); ++c) {
      if (out[c].data == nullptr) continue;
      launcher_.download(host.data(), planes[c].data, host.size() * sizeof(float));
      for (std::size_t i = 0; i < host.size(); ++i) out[c].data[i * std::size_t(out[c].stride)] = host[i];
    }
  }

  void backward(const std::vector<Plane<const float>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<float>& out) override {
    const DeviceBuffer<Launcher, float> image(launcher_, std::int64_t(grad.size()) * pixels_);
    std::vector<Plane<const float>> planes;
    std::vector<float> host(static_cast<std::size_t>(pixels_));
    for (std::size_t c = 0; c < grad.size(); ++c) {
      float* plane = image.data() + std::int64_t(c) * pixels_;
      planes.push_back({grad[c].data ? plane : nullptr, 1});
      if (grad[c].data == nullptr) continue;
      for (std::size_t i = 0; i < host.size(); ++i) host[i] = grad[c].data[i * std::size_t(grad[c].stride)];
      launcher_.upload(plane, host.data(), host.size() * sizeof(float));
    }
    const CloudView<float>& cloud = cloud_.view();
    Columns columns(launcher_, cloud, plan_.labels(), out);
    splat_.backward(planes, moves, columns.view, sums_);
    columns.download(out);
  }

 private:
  /// The requested columns of the gradient.
  struct Columns {
    DeviceBuffer<Launcher, float> position, rotation, log_scale, logit_opacity, sh_dc, sh_rest, label, mean_px;
    DeviceBuffer<Launcher, std::uint8_t> visible, label_alone;
    DeviceBuffer<Launcher, std::int32_t> place;
    CloudGradientView<float> view;

    Columns(Launcher& launcher, const CloudView<float>& cloud, int labels, const CloudGradientView<float>& wanted) {
      const std::int64_t rows = wanted.place ? wanted.rows : cloud.size;
      const auto make = [&](auto& buffer, auto* host, auto*& pointer, int width) {
        if (host == nullptr || width == 0) return;
        buffer = {launcher, rows * width};
        pointer = buffer.data();
      };
      make(position, wanted.position, view.position, 3), make(rotation, wanted.rotation, view.rotation, 4);
      make(log_scale, wanted.log_scale, view.log_scale, 3);
      make(logit_opacity, wanted.logit_opacity, view.logit_opacity, 1);
      make(sh_dc, wanted.sh_dc, view.sh_dc, 3), make(sh_rest, wanted.sh_rest, view.sh_rest, cloud.rest_stride * 3);
      make(label, wanted.label, view.label, labels), make(mean_px, wanted.mean_px, view.mean_px, 2);
      make(visible, wanted.visible, view.visible, 1);
      if (wanted.label_alone)
        label_alone = {launcher, wanted.label_alone, cloud.size}, view.label_alone = label_alone.data();
      if (wanted.place) place = {launcher, wanted.place, cloud.size}, view.place = place.data(), view.rows = rows;
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
  CloudOnDevice<Launcher> cloud_;
  DeviceBuffer<Launcher, float> label_;
  SplatOnDevice<Launcher> splat_;
};

template <class Launcher>
class LaunchedSplatOps final : public DeviceSplatOps {
 public:
  LaunchedSplatOps(Launcher& launcher, DeviceSums sums) : launcher_(launcher), sums_(sums) {}

  std::unique_ptr<DeviceSplat> view(const ViewProjector<float>& view, const CloudView<float>& cloud,
                                    const ChannelPlan<float>& plan) const override {
    return std::make_unique<LaunchedSplatView<Launcher>>(launcher_, sums_, view, cloud, plan);
  }

  std::vector<double> evidence(const ViewProjector<float>& view, const CloudView<float>& cloud,
                               const ViewMasks& masks) const override {
    const CloudOnDevice<Launcher> on_device(launcher_, cloud);
    const TileBins<Launcher> bins(launcher_, view, on_device.view());
    const std::int64_t pixels = std::int64_t(view.width_px) * view.height_px;
    const auto objects = std::int64_t(masks.target.size());
    const DeviceBuffer<Launcher, std::uint8_t> known(launcher_, masks.known);
    const DeviceBuffer<Launcher, float> target(launcher_, objects * pixels);
    for (std::int64_t k = 0; k < objects; ++k)
      launcher_.upload(target.data() + k * pixels, masks.target[std::size_t(k)].data(),
                       std::size_t(pixels) * sizeof(float));
    std::vector<double> sums;
    evidence_sums(launcher_, bins, {known.data(), target.data(), pixels, int(objects)}).to(sums);
    return sums;
  }

 private:
  Launcher& launcher_;
  DeviceSums sums_;
};

}  // namespace ngs
