#include "ngs/stages/scene/view_align.h"

#include <mutex>

#include "ngs/backend/for_each.h"
#include "ngs/problem/view_list.h"
#include "ngs/stages/render/background.h"
#include "ngs/stages/render/render_options.h"
#include "ngs/stages/scene/pose_check.h"

namespace ngs {
namespace {

constexpr int kMostSteps = 15, kPatience = 2;  // steps in all, and in a row that do not lower the error
constexpr double kSettled_px = 0.03;

Vec3<float> fitted_background(const RenderedView& view, const ImageF& photo) {
  const Vec3<double> b = match_rendered(view, photo).background;
  return {float(b.x), float(b.y), float(b.z)};
}

ViewAlignment align(const GaussianCloud& cloud, const SplatOptions& splat, const Camera& start,
                    const ImageF& photo) {
  ViewAlignment best;
  Vec3<float> background;  // that of the first picture: it is fitted to what is rendered anyway
  RenderRequest request;
  request.depth = true;
  const ImageF smooth = smoothed_for_pose(photo);
  Camera camera = start;
  CameraMotion total;
  double total_px = 0;
  int in_vain = 0;
  for (int step = 0; step < kMostSteps && in_vain < kPatience; ++step) {
    RenderedView view = render({}, cloud, camera, splat, request);
    if (step == 0) background = fitted_background(view, photo);
    const PoseStep found = pose_step(over_background(std::move(view), background), smooth, camera, total);
    if (!found.determined) break;
    if (step == 0) best.error_before = best.error_after = found.error;
    in_vain = step > 0 && found.error >= best.error_after ? in_vain + 1 : 0;
    if (found.error < best.error_after)
      best.motion = total, best.flow_px = total_px, best.error_after = found.error, best.camera = camera;
    if (found.flow_px < kSettled_px) break;
    camera = moved(camera, found.motion);
    total.turn = total.turn + found.motion.turn, total.move = total.move + found.motion.move;
    total_px = found.total_px;
  }
  best.applied = best.flow_px >= kLeastFlow_px && best.flow_px <= kMostFlow_px;
  return best;
}

}  // namespace

std::vector<ViewAlignment> measure_alignment(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud,
                                             const Scene& scene,
                                             const std::function<ImageF(std::size_t view)>& load_photo) {
  const auto timed = monitor.scope("align views");
  const SplatOptions splat = splat_options({}, cloud, scene);
  std::vector<ViewAlignment> alignment;
  for (const std::size_t v : photo_views(scene)) alignment.emplace_back().view = v;
  std::mutex telling;
  std::int64_t done = 0;
  for_each_task(exec, std::int64_t(alignment.size()), [&](std::int64_t i) {
    ViewAlignment& of_view = alignment[std::size_t(i)];
    const std::size_t v = of_view.view;
    of_view = align(cloud, splat, scene.views[v].camera, load_photo(v));
    of_view.view = v;
    const std::lock_guard lock(telling);
    monitor.progress(++done, std::int64_t(alignment.size()));
  });
  return alignment;
}

void apply_alignment(const std::vector<ViewAlignment>& alignment, Scene& scene) {
  for (const ViewAlignment& a : alignment)
    if (a.applied) scene.views[a.view].camera = a.camera;
}

}  // namespace ngs
