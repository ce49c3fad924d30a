#include "ngs/cut/contours/unexplained_contrast.h"

#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_stage.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

/// Sums over the pixels of one view.
struct ViewResidual {
  double difference = 0, moved_px = 0, contrast = 0;
  bool shows_object = false;
};

/// Rendering of the window at `scale` times the camera's size, averaged to the camera's size like the photo.
ImageF rendering_of(const PreparedModel& model, const Vec3<float>& background, const Camera& window, int scale) {
  RenderRequest request;
  request.background = background;
  const Camera camera = resized(window, scale * window.width_px, scale * window.height_px);
  const ImageF fine =
      render(model.exec, model.labels.cloud(), camera, filter_at_scale(model.splat, scale), request).colour;
  ImageF mean(window.width_px, window.height_px, 3);
  for (int y = 0; y < fine.height_px; ++y)
    for (int x = 0; x < fine.width_px; ++x)
      for (int c = 0; c < 3; ++c) mean.at(x / scale, y / scale, c) += fine.at(x, y, c) / float(scale * scale);
  return mean;
}

/// |photo - rendering| summed over the channels, at pixel p.
double difference_at(const ImageF& photo, const ImageF& rendering, std::size_t p) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c)
    sum += std::abs(double(photo.data[3 * p + c]) - double(rendering.data[3 * p + c]));
  return sum;
}

ViewResidual residual_of(const Problem& problem, const PreparedModel& model, std::size_t v,
                         const RefinedView& refined) {
  ViewResidual out;
  const PixelWindow& win = refined.window;
  ImageF photo = problem.load_photo(v);
  if (win.w == 0 || photo.empty()) return out;
  photo.data = cropped(photo.data, photo.width_px, photo.channels, win);
  photo.width_px = win.w;
  photo.height_px = win.h;
  const Camera camera = window_camera(problem.scene.views[v].camera, win);
  const int scale = refined.detail == 2 || refined.detail == 4 ? int(refined.detail) : 1;
  const LabelChannels& labels = model.labels;
  const ImageF rendering = rendering_of(model, problem.background, camera, scale);
  const ImageF rendered = labels.masks(model.exec, camera, model.splat);
  const ViewMasks moved_to = refined.masks.unpacked();
  for (std::size_t k = 0; k < labels.objects(); ++k) {
    std::vector<std::uint8_t> mask(std::size_t(win.w) * std::size_t(win.h));
    for (std::size_t p = 0; p < mask.size(); ++p) {
      mask[p] = mask_is_foreground(moved_to.target[k][p]);
      if (bool(mask[p]) == label_is_foreground(rendered.data[p * labels.objects() + k])) continue;
      out.difference += difference_at(photo, rendering, p);
      ++out.moved_px;
    }
    out.contrast += contour_contrast(mask, photo) / double(labels.objects());
  }
  out.shows_object = true;
  return out;
}

}  // namespace

double unexplained_contrast(const Exec& exec, const Problem& problem, const LabelledModel& model,
                            const std::vector<std::size_t>& views, const std::vector<RefinedView>& refined) {
  const PreparedModel prepared(exec, problem.splat, model);
  std::vector<ViewResidual> of(views.size());
  for_each_task(exec, std::int64_t(views.size()), [&](std::int64_t i) {
    const std::size_t v = views[std::size_t(i)];
    if (!stop_requested(problem.monitor) && refined[v].masks.available())
      of[std::size_t(i)] = residual_of(problem, prepared, v, refined[v]);
  });
  ViewResidual all;
  double shown = 0;
  for (const ViewResidual& view : of) {
    all.difference += view.difference;
    all.moved_px += view.moved_px;
    all.contrast += view.contrast;
    shown += view.shows_object;
  }
  if (all.moved_px == 0) return 0;
  return all.contrast > 0 ? all.difference / all.moved_px / (all.contrast / shown) : INFINITY;
}

bool explains_photos(const Exec& exec, const Problem& problem, const LabelledModel& model,
                     const std::vector<RefinedView>& refined) {
  std::vector<std::size_t> compared;
  for (std::size_t v = 0; v < refined.size(); ++v)
    if (refined[v].compared) compared.push_back(v);
  return unexplained_contrast(exec, problem, model, compared, refined) < kExplained;
}

bool masks_reject(const Exec& exec, const RefineSetup& setup, const LabelledModel& model,
                  const std::vector<RefinedView>& refined) {
  if (mask_agreement_gain(refined) >= -kSignificant) return false;
  const Problem& problem = setup.problem;
  if (!problem.labels.empty() && mask_agreement_gain(refine_views(exec, setup, {problem.cloud, problem.labels},
                                                                  problem.views, problem.views)) >= -kSignificant)
    return false;
  return !masks_misaligned(refined) || explains_photos(exec, problem, model, refined);
}

}  // namespace ngs
