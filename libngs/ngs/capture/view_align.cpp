#include "ngs/capture/view_align.h"

#include <algorithm>
#include <iterator>

#include "ngs/backend/for_each.h"
#include "ngs/capture/pose_check.h"
#include "ngs/core/progress_count.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/background.h"
#include "ngs/render/render_options.h"

namespace ngs {
namespace {

constexpr int kMaxRenders = 15;
// Of larger pictures every second, third ... column and row is compared: the images are smooth, so neighbours add
// little.
constexpr std::int64_t kManyPixels = 1 << 16;

int pixel_step_of(const ImageF& photo) {
  int step = 1;
  while (photo.pixels() >= kManyPixels * step * step) ++step;
  return step;
}

Vec3<float> fitted_background(const RenderedView& view, const ImageF& photo) {
  const Vec3<double> b = match_rendered(view, photo).background;
  return {float(b.x), float(b.y), float(b.z)};
}

/// `with_background`: also measures the background against the photo.
ViewAlignment align(const PhotographedModel& model, const SplatOptions& splat, std::size_t view_index,
                    bool with_background) {
  ViewAlignment best;
  best.view = view_index;
  const ImageF photo = model.load_photo(view_index), smooth = smoothed_for_pose(photo);
  const int pixel_step = pixel_step_of(photo);
  RenderRequest request;
  request.depth = true;
  RenderedView at_start, at_best;  // over black; at_best: of a moved camera
  Vec3<float> background;          // fitted to the first render
  Camera camera = model.scene.views[view_index].camera;
  CameraMotion total;
  double total_px = 0;
  for (int step = 0; step < kMaxRenders; ++step) {
    RenderedView view = render({}, model.cloud, camera, splat, request);
    if (step == 0) background = fitted_background(view, photo);
    const PoseStep found = pose_step(over_background(view, background), smooth, camera, total, pixel_step);
    const bool better = step > 0 && found.determined && found.error < best.error_after;
    if (step == 0 && found.determined) best.error_before = best.error_after = found.error;
    if (better) {
      best.motion = total;
      best.flow_px = total_px;
      best.error_after = found.error;
      best.camera = camera;
    }
    if (step == 0 || better) (better ? at_best : at_start) = std::move(view);
    if (step == 0) best.at_rest = found.determined && found.flow_px < kMinFlow_px;
    if (step > 0 && !better) break;
    if (!found.determined || found.flow_px < kSettled_px || found.total_px < kMinFlow_px) break;
    camera = moved(camera, found.motion);
    total.turn = total.turn + found.motion.turn;
    total.move = total.move + found.motion.move;
    total_px = found.total_px;
  }
  best.applied = best.flow_px >= kMinFlow_px && best.flow_px <= kMaxFlow_px;
  if (with_background) best.background = measure_background(best.applied ? at_best : at_start, photo);
  return best;
}

}  // namespace

std::vector<ViewAlignment> measure_alignment(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                                             const std::vector<std::size_t>& background_views) {
  const auto timed = monitor.scope("align views");
  SplatOptions splat = splat_options({}, model.cloud, model.scene);
  splat.prepared = prepare_cloud(exec, model.cloud);
  const std::vector<std::size_t> views = photo_views(model.scene);
  std::vector<std::size_t> first = spread_views(views, kAlignedFirst), others;
  first.insert(first.end(), background_views.begin(), background_views.end());
  std::ranges::sort(first);
  first.erase(std::unique(first.begin(), first.end()), first.end());
  std::ranges::set_difference(views, first, std::back_inserter(others));
  std::vector<ViewAlignment> alignment;
  const auto measure = [&](const std::vector<std::size_t>& some) {
    const std::size_t begin = alignment.size();
    alignment.resize(begin + some.size());
    ProgressCount progress(monitor, std::int64_t(some.size()));
    for_each_task(exec, std::int64_t(some.size()), [&](std::int64_t i) {
      const std::size_t v = some[std::size_t(i)];
      const bool with_background = std::ranges::find(background_views, v) != background_views.end();
      alignment[begin + std::size_t(i)] = align(model, splat, v, with_background);
      progress.add_one();
    });
  };
  measure(first);
  if (!std::ranges::all_of(alignment, &ViewAlignment::at_rest)) measure(others);
  std::ranges::sort(alignment, {}, &ViewAlignment::view);
  return alignment;
}

void apply_alignment(const std::vector<ViewAlignment>& alignment, Scene& scene) {
  for (const ViewAlignment& a : alignment)
    if (a.applied) scene.views[a.view].camera = a.camera;
}

}  // namespace ngs
