#include "ngs/edit/extract/inpaint_stage.h"

#include "ngs/core/check.h"
#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/ops/image/metrics.h"

namespace ngs {

std::vector<std::uint8_t> seen_gaussians(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud,
                                         const Scene& scene, const SplatOptions& splat) {
  std::vector<std::uint8_t> seen(std::size_t(cloud.size()));
  for (const SceneView& view : scene.views) {
    const auto timed = monitor.scope("visibility");
    const PixelMask nothing(std::size_t(view.camera.width_px) * std::size_t(view.camera.height_px));
    for (const std::uint32_t row : lift_mask(exec, cloud, view.camera, splat, nothing).row) seen[row] = 1;
  }
  return seen;
}

ViewHole find_hole(const Exec& exec, const InpaintOptions& options, const InpaintModel& model, const Camera& camera,
                   const SplatOptions& splat) {
  const auto n = std::size_t(model.cloud.size());
  NGS_CHECK(model.object.size() == n && model.seen.size() == n, "one entry per Gaussian");
  std::vector<float> is_object(n), is_seen(n);
  std::vector<std::uint8_t> rest(n);
  for (std::size_t i = 0; i < n; ++i) {
    is_object[i] = model.object[i];
    is_seen[i] = model.seen[i];
    rest[i] = !model.object[i];
  }
  RenderRequest full;
  full.colour = false;
  full.label = {is_object.data(), model.cloud.size(), 1};
  RenderRequest remaining;
  remaining.label = {is_seen.data(), model.cloud.size(), 1};
  remaining.include = rest.data();
  remaining.background = model.background;
  const RenderedView before = render(exec, model.cloud, camera, splat, full);
  RenderedView after = render(exec, model.cloud, camera, splat, remaining);

  ViewHole out;
  out.hole.resize(before.label.data.size());
  for (std::size_t p = 0; p < out.hole.size(); ++p)
    out.hole[p] = before.label.data[p] >= kMinObjectShare && after.label.data[p] < kHoleOpacity;
  out.dilated = dilated(out.hole, camera.width_px, camera.height_px, options.inpaint_dilate_px);
  out.colour = std::move(after.colour);
  return out;
}

PixelMask dilated(const PixelMask& mask, int width_px, int height_px, int margin_px) {
  const std::vector<std::int32_t> distance = signed_distance({mask.data(), width_px, height_px});
  PixelMask out(mask.size());
  for (std::size_t p = 0; p < mask.size(); ++p) out[p] = -distance[p] <= margin_px;
  return out;
}

}  // namespace ngs
