#include "ngs/stages/view_shift.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/try_each.h"
#include "ngs/ops/image_shift.h"
#include "ngs/stages/pose_check.h"

namespace ngs {
namespace {

constexpr int kRenderings = 2;  // a shift is measured on the picture at the shift before

Camera shifted(Camera camera, double dx_px, double dy_px) {
  camera.cx += dx_px, camera.cy += dy_px;
  return camera;
}

ImageShift shift_at(const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat,
                    const Vec3<double>& background, const ImageF& photo) {
  RenderRequest request;
  request.background = {float(background.x), float(background.y), float(background.z)};
  const RenderedView view = render({}, cloud, camera, splat, request);
  return find_shift(view.colour, photo, view.alpha);
}

ViewShift measure(const GaussianCloud& cloud, const SplatOptions& splat, const Camera& camera,
                  const ImageF& photo) {
  ViewShift out;
  const Vec3<double> background = match_photo({}, cloud, camera, splat, photo).background;
  for (int round = 0; round < kRenderings; ++round) {
    const ImageShift shift = shift_at(cloud, shifted(camera, out.dx_px, out.dy_px), splat, background, photo);
    if (round == 0) out.error_before = out.error_after = shift.error_before;
    if (!shift.converged) return out;
    out.dx_px += shift.dx_px, out.dy_px += shift.dy_px;
  }
  out.error_after =
      shift_at(cloud, shifted(camera, out.dx_px, out.dy_px), splat, background, photo).error_before;
  const double length = std::hypot(out.dx_px, out.dy_px);
  out.applied = length >= kLeastShift_px && length <= kMostShift_px && out.error_after < out.error_before;
  return out;
}

}  // namespace

std::vector<ViewShift> measure_view_shifts(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud,
                                           const Scene& scene,
                                           const std::function<ImageF(std::size_t view)>& load_photo) {
  const auto timed = monitor.scope("view shifts");
  SplatOptions splat{.antialiased = cloud.antialiased};
  splat.blur_px2 = scene.filter_px2;
  std::vector<ViewShift> shifts;
  for (std::size_t v = 0; v < scene.views.size(); ++v)
    if (!scene.views[v].image_path.empty()) shifts.push_back({.view = v});
  try_each_task(exec, std::int64_t(shifts.size()), [&](std::int64_t i) {
    ViewShift& shift = shifts[std::size_t(i)];
    const std::size_t v = shift.view;
    shift = measure(cloud, splat, scene.views[v].camera, load_photo(v));
    shift.view = v;
  });
  return shifts;
}

void apply_view_shifts(const std::vector<ViewShift>& shifts, Scene& scene) {
  for (const ViewShift& s : shifts)
    if (s.applied) scene.views[s.view].camera = shifted(scene.views[s.view].camera, s.dx_px, s.dy_px);
}

}  // namespace ngs
