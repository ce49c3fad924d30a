#pragma once
// DeviceSplatOps on a Grid: copies in, the schedules, copies out.
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/device/evidence_schedule.h"
#include "ngs/ops/device/splat_schedule.h"

namespace ngs {

template <class Grid>
class GridSplatView final : public DeviceSplat {
 public:
  GridSplatView(Grid& grid, DeviceSums sums, const Camera& camera, const SplatOptions& options, const CloudView<float>& cloud,
                const ChannelPlan<float>& plan, Vec3<float> background)
      : grid_(grid), sums_(sums), plan_(plan), pixels_(std::int64_t(camera.width_px) * camera.height_px), cloud_(grid, cloud),
        label_(grid, plan.label.data, plan.label.n * plan.label.c),
        splat_(grid, camera, options, cloud_.view(),
               {plan.colour, plan.depth, {label_.data(), plan.label.n, plan.label.c}}, background) {}

  void forward(const std::vector<Plane<float>>& out) override {
    const DeviceBuffer<Grid, float> image(grid_, std::int64_t(out.size()) * pixels_);
    std::vector<Plane<float>> planes;
    for (std::size_t c = 0; c < out.size(); ++c)
      planes.push_back({out[c].data ? image.data() + std::int64_t(c) * pixels_ : nullptr, 1});
    splat_.forward(planes);
    std::vector<float> host(static_cast<std::size_t>(pixels_));
    for (std::size_t c = 0; c < out.size(); ++c) {
      if (out[c].data == nullptr) continue;
      grid_.download(host.data(), planes[c].data, host.size() * sizeof(float));
      for (std::size_t i = 0; i < host.size(); ++i) out[c].data[i * std::size_t(out[c].stride)] = host[i];
    }
  }

  void backward(const std::vector<Plane<const float>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<float>& out) override {
    const DeviceBuffer<Grid, float> image(grid_, std::int64_t(grad.size()) * pixels_);
    std::vector<Plane<const float>> planes;
    std::vector<float> host(static_cast<std::size_t>(pixels_));
    for (std::size_t c = 0; c < grad.size(); ++c) {
      float* plane = image.data() + std::int64_t(c) * pixels_;
      planes.push_back({grad[c].data ? plane : nullptr, 1});
      if (grad[c].data == nullptr) continue;
      for (std::size_t i = 0; i < host.size(); ++i) host[i] = grad[c].data[i * std::size_t(grad[c].stride)];
      grid_.upload(plane, host.data(), host.size() * sizeof(float));
    }
    const CloudView<float>& cloud = cloud_.view();
    Columns columns(grid_, cloud, plan_.labels(), out);
    splat_.backward(planes, moves, columns.view, sums_);
    columns.download(out);
  }

 private:
  /// The wanted columns of the gradient.
  struct Columns {
    DeviceBuffer<Grid, float> position, rotation, log_scale, logit_opacity, sh_dc, sh_rest, label, mean_px;
    DeviceBuffer<Grid, std::uint8_t> visible, label_alone;
    CloudGradientView<float> view;

    Columns(Grid& grid, const CloudView<float>& cloud, int labels, const CloudGradientView<float>& wanted) {
      const auto make = [&](auto& buffer, auto* host, auto*& pointer, int width) {
        if (host == nullptr || width == 0) return;
        buffer = {grid, cloud.size * width};
        pointer = buffer.data();
      };
      make(position, wanted.position, view.position, 3), make(rotation, wanted.rotation, view.rotation, 4);
      make(log_scale, wanted.log_scale, view.log_scale, 3);
      make(logit_opacity, wanted.logit_opacity, view.logit_opacity, 1);
      make(sh_dc, wanted.sh_dc, view.sh_dc, 3), make(sh_rest, wanted.sh_rest, view.sh_rest, cloud.rest_stride * 3);
      make(label, wanted.label, view.label, labels), make(mean_px, wanted.mean_px, view.mean_px, 2);
      make(visible, wanted.visible, view.visible, 1);
      if (wanted.label_alone) label_alone = {grid, wanted.label_alone, cloud.size}, view.label_alone = label_alone.data();
    }
    void download(const CloudGradientView<float>& to) const {
      position.to(to.position), rotation.to(to.rotation), log_scale.to(to.log_scale), logit_opacity.to(to.logit_opacity);
      sh_dc.to(to.sh_dc), sh_rest.to(to.sh_rest), label.to(to.label), mean_px.to(to.mean_px), visible.to(to.visible);
    }
  };

  Grid& grid_;
  DeviceSums sums_;
  ChannelPlan<float> plan_;
  std::int64_t pixels_;
  CloudOnGrid<Grid> cloud_;
  DeviceBuffer<Grid, float> label_;
  GridSplat<Grid> splat_;
};

template <class Grid>
class LaunchedSplatOps final : public DeviceSplatOps {
 public:
  LaunchedSplatOps(Grid& grid, DeviceSums sums) : grid_(grid), sums_(sums) {}

  std::unique_ptr<DeviceSplat> view(const Camera& camera, const SplatOptions& options, const CloudView<float>& cloud,
                                    const ChannelPlan<float>& plan, Vec3<float> background) const override {
    return std::make_unique<GridSplatView<Grid>>(grid_, sums_, camera, options, cloud, plan, background);
  }

  std::vector<double> evidence(const Camera& camera, const SplatOptions& options, const CloudView<float>& cloud,
                               const ViewMasks& masks) const override {
    const CloudOnGrid<Grid> on_grid(grid_, cloud);
    const TileBins<Grid> bins(grid_, view_projector<float>(camera, options), on_grid.view(), camera.width_px,
                              camera.height_px);
    const std::int64_t pixels = std::int64_t(camera.width_px) * camera.height_px;
    const auto objects = std::int64_t(masks.target.size());
    const DeviceBuffer<Grid, std::uint8_t> known(grid_, masks.known);
    const DeviceBuffer<Grid, float> target(grid_, objects * pixels);
    for (std::int64_t k = 0; k < objects; ++k)
      grid_.upload(target.data() + k * pixels, masks.target[std::size_t(k)].data(), std::size_t(pixels) * sizeof(float));
    std::vector<double> sums;
    evidence_sums(grid_, bins, cloud.size, known.data(), target.data(), pixels, int(objects)).to(sums);
    return sums;
  }

 private:
  Grid& grid_;
  DeviceSums sums_;
};

}  // namespace ngs
