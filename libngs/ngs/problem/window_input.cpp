#include "ngs/problem/window_input.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ngs/backend/for_each.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/resize.h"

namespace ngs {
namespace {

constexpr int kMinMargin_px = 48, kMaxMargin_px = 64;
constexpr int kShrink = 4;           // reduction of the renderings of the objects
constexpr float kMinOpacity = 0.1f;  // minimum opacity of a visible pixel

PixelWindow merged(const PixelWindow& a, const PixelWindow& b) {
  if (a.w == 0) return b;
  if (b.w == 0) return a;
  const int x0 = std::min(a.x0, b.x0), y0 = std::min(a.y0, b.y0);
  return {x0, y0, std::max(a.x0 + a.w, b.x0 + b.w) - x0, std::max(a.y0 + a.h, b.y0 + b.h) - y0};
}

/// The half-open range of indices that contains all of `count` except kOutlierShare of the sum at each side.
std::pair<int, int> core_range(const std::vector<double>& count) {
  double all = 0;
  for (const double c : count) all += c;
  int begin = 0, end = int(count.size());
  for (double left = kOutlierShare * all; begin < end && (left -= count[std::size_t(begin)]) >= 0;) ++begin;
  for (double left = kOutlierShare * all; begin < end && (left -= count[std::size_t(end - 1)]) >= 0;) --end;
  return {begin, end};
}

/// Box of the visible pixels of an opacity image, without outliers.
PixelWindow shown_window(const ImageF& alpha) {
  std::vector<double> columns(std::size_t(alpha.width_px)), rows(std::size_t(alpha.height_px));
  double all = 0;
  for (int y = 0; y < alpha.height_px; ++y)
    for (int x = 0; x < alpha.width_px; ++x)
      if (alpha.at(x, y, 0) > kMinOpacity) {
        ++columns[std::size_t(x)];
        ++rows[std::size_t(y)];
        ++all;
      }
  if (all == 0) return {};
  const auto [x0, x1] = core_range(columns);
  const auto [y0, y1] = core_range(rows);
  return {x0, y0, x1 - x0, y1 - y0};
}

PixelWindow with_margin(const PixelWindow& w, const Camera& camera) {
  const int margin_px = std::clamp(std::max(w.w, w.h) / 5, kMinMargin_px, kMaxMargin_px);
  return widened(w, margin_px, camera.width_px, camera.height_px);
}

Scene with_windows(Scene scene, const std::vector<PixelWindow>& windows) {
  for (std::size_t v = 0; v < windows.size(); ++v)
    if (windows[v].w > 0)
      scene.views[v].camera = window_camera(scene.views[v].camera, windows[v]);
    else
      scene.views[v].image_path.clear();
  return scene;
}

/// Share of each view's pixels inside its window; 1 without a window.
std::vector<double> shares(const Scene& uncropped, const std::vector<PixelWindow>& windows) {
  std::vector<double> share(windows.size(), 1.0);
  for (std::size_t v = 0; v < windows.size(); ++v) {
    const Camera& camera = uncropped.views[v].camera;
    if (windows[v].w > 0) share[v] = double(windows[v].w) * windows[v].h / (double(camera.width_px) * camera.height_px);
  }
  return share;
}

/// The boxes of the masks, without margins.
ObjectWindows mask_windows(const Exec& exec, const Problem& problem) {
  ObjectWindows out;
  out.window.resize(problem.scene.views.size());
  out.masks.resize(problem.scene.views.size());
  for_each_task(exec, std::int64_t(problem.views.size()), [&](std::int64_t n) {
    if (stop_requested(problem.monitor)) return;
    const std::size_t v = problem.views[std::size_t(n)];
    ViewMasks masks = problem.load_masks(v);
    if (masks.available) out.window[v] = window_of(masks.target, masks.width_px, masks.height_px, 0);
    out.masks[v] = RleMasks(std::move(masks));
  });
  return out;
}

PixelWindow enlarged(const PixelWindow& w) { return {w.x0 * kShrink, w.y0 * kShrink, w.w * kShrink, w.h * kShrink}; }

/// Visibility of the labelled Gaussians in renderings at 1 / kShrink of the views' size.
class LowResVisibility {
 public:
  LowResVisibility(const Exec& exec, const Problem& problem)
      : exec_(exec), problem_(problem), label_(std::size_t(problem.cloud.size())), resident_(exec) {
    std::vector<std::int64_t> rows;
    for (const LabelColumns& object : problem.labels)
      for (std::size_t i = 0; i < label_.size(); ++i)
        if (label_is_foreground(object.label[i])) label_[i] = 1;
    for (std::size_t i = 0; i < label_.size(); ++i)
      if (label_[i] > 0) rows.push_back(std::int64_t(i));
    objects_ = gather_rows(exec, problem.cloud, rows);
    alone_ = prepared_for(exec, filter_at_scale(problem.splat, 1.0 / kShrink), objects_);
  }

  PixelWindow of_objects_alone(std::size_t view) const {
    RenderRequest request{.colour = false, .label = {}};
    return shown_window(render(exec_, objects_, camera(view), alone_, request).alpha);
  }
  /// True: inside the window `alone`, other Gaussians occlude all objects.
  bool occluded(std::size_t view, const PixelWindow& alone) {
    if (!among_all_) {
      among_all_ = prepared_for(exec_, filter_at_scale(problem_.splat, 1.0 / kShrink), problem_.cloud);
      resident_.add_input(label_);
    }
    RenderRequest request{.colour = false, .label = {label_.data(), problem_.cloud.size(), 1}};
    const Camera there = window_camera(camera(view), alone);
    return shown_window(render(exec_, problem_.cloud, there, *among_all_, request).label).w == 0;
  }

 private:
  Camera camera(std::size_t view) const { return shrunk(problem_.scene.views[view].camera, kShrink); }

  const Exec& exec_;
  const Problem& problem_;
  std::vector<float> label_;  // [N] 1: labelled as an object
  GaussianCloud objects_;     // the labelled Gaussians
  SplatOptions alone_;
  std::optional<SplatOptions> among_all_;  // created at its first use
  Resident resident_;                      // label_, with among_all_
};

/// The training views and the views with a photo, sorted.
std::vector<std::size_t> views_in_use(const Problem& problem) {
  std::vector<std::size_t> seen = photo_views(problem.scene);
  seen.insert(seen.end(), problem.views.begin(), problem.views.end());
  std::ranges::sort(seen);
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

/// Share of the pixels of these views outside their windows.
double share_outside(const Scene& scene, const std::vector<std::size_t>& views, const ObjectWindows& windows) {
  double inside_px = 0, all_px = 0;
  for (const std::size_t v : views) {
    const Camera& camera = scene.views[v].camera;
    inside_px += double(windows.window[v].w) * windows.window[v].h;
    all_px += double(camera.width_px) * camera.height_px;
  }
  return all_px > 0 ? 1 - inside_px / all_px : 0;
}

}  // namespace

ObjectWindows object_windows(const Exec& exec, const Problem& problem, ObjectWindows of_masks) {
  const Scene& scene = problem.scene;
  ObjectWindows out = of_masks.window.empty() ? mask_windows(exec, problem) : std::move(of_masks);
  LowResVisibility visibility(exec, problem);
  const std::vector<std::size_t> seen = views_in_use(problem);
  const bool all = for_each_view(problem.monitor, seen, [&](std::size_t, std::size_t v) {
    PixelWindow& window = out.window[v];
    const PixelWindow alone = visibility.of_objects_alone(v);
    const bool mask_is_empty = out.masks[v].available() && window.w == 0;
    if (mask_is_empty && alone.w > 0 && visibility.occluded(v, alone)) return;
    window = with_margin(merged(window, enlarged(alone)), scene.views[v].camera);
  });
  if (!all) return {};
  out.outside = share_outside(scene, seen, out);
  return out;
}

ObjectWindows windows_of_masks(const Exec& exec, const Problem& problem) {
  ObjectWindows out = mask_windows(exec, problem);
  std::vector<PixelWindow> boxes = out.window;
  for (const std::size_t v : problem.views) out.window[v] = with_margin(out.window[v], problem.scene.views[v].camera);
  out.outside = share_outside(problem.scene, views_in_use(problem), out);
  out.window = std::move(boxes);
  return out;
}

WindowInput::WindowInput(const Problem& uncropped, std::shared_ptr<const ObjectWindows> windows)
    : uncropped_(uncropped),
      windows_(std::move(windows)),
      scene_(with_windows(uncropped.scene, windows_->window)),
      cropped_(uncropped.cropped(
          scene_, [this](std::size_t view) { return masks(view); },
          [this](std::size_t view) { return cropped_photo(uncropped_.load_photo(view), view); },
          shares(uncropped.scene, windows_->window))) {
  cropped_.views.clear();
  for (const std::size_t v : uncropped.views)
    if (windows_->window[v].w > 0) cropped_.views.push_back(v);
  if (uncropped.load_fine_photo)
    cropped_.load_fine_photo = [this](std::size_t view) {
      return cropped_photo(uncropped_.load_fine_photo(view), view);
    };
}

ViewMasks WindowInput::masks(std::size_t view) const {
  ViewMasks masks = windows_->masks[view].unpacked();
  return masks.available ? ngs::cropped(std::move(masks), windows_->window[view]) : masks;
}

/// Crops a photo of any size. The window's edges are rounded to the nearest pixel.
ImageF WindowInput::cropped_photo(const ImageF& photo, std::size_t view) const {
  const PixelWindow& window = windows_->window[view];
  if (photo.empty()) return {};
  const Camera& camera = uncropped_.scene.views[view].camera;
  const auto at = [](int v, int from, int to) { return int(std::lround(double(v) * to / from)); };
  const int x0 = at(window.x0, camera.width_px, photo.width_px), y0 = at(window.y0, camera.height_px, photo.height_px);
  const PixelWindow fine{x0, y0, at(window.x0 + window.w, camera.width_px, photo.width_px) - x0,
                         at(window.y0 + window.h, camera.height_px, photo.height_px) - y0};
  ImageF part;
  part.width_px = fine.w;
  part.height_px = fine.h;
  part.channels = photo.channels;
  part.data = ngs::cropped(photo.data, photo.width_px, photo.channels, fine);
  return part;
}

}  // namespace ngs
