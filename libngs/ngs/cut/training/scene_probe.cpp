#include "ngs/cut/training/scene_probe.h"

#include <algorithm>
#include <iterator>

#include "ngs/cut/contours/unexplained_contrast.h"
#include "ngs/cut/training/effect.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_stage.h"

namespace ngs {
namespace {

/// Adds one view to LabelViews. Returns the number of objects added to the mean.
std::size_t add_view(const Exec& exec, const ImageF& rendered, const ViewMasks& masks, LabelViews& views) {
  double sum = 0;
  bool shown = false;
  const std::vector<ForegroundBox> boxes = foreground_boxes(rendered);
  for (std::size_t k = 0; k < masks.target.size(); ++k) {
    const MaskPair pair(rendered, masks, k, boxes[k]);
    const Confusion counts = pair.counts(exec);
    sum += disagreement(counts);
    shown |= !counts.both_empty();
    views.biou += pair.biou(exec);
  }
  views.disagreement.push_back(sum);
  views.shown.push_back(shown);
  const PixelWindow w = window_of(masks.target, masks.width_px, masks.height_px, kAnchorMargin_px);
  if (w.w > 0) views.outside = std::max(views.outside, weight_outside(rendered, w.x0, w.y0, w.x0 + w.w, w.y0 + w.h));
  return masks.target.size();
}

constexpr double kMargin_px = 16;  // of the windows about the object

/// `views` without `some`; both must be sorted.
std::vector<std::size_t> without(const std::vector<std::size_t>& views, const std::vector<std::size_t>& some) {
  std::vector<std::size_t> rest;
  std::ranges::set_difference(views, some, std::back_inserter(rest));
  return rest;
}

}  // namespace

double disagreement(const Confusion& counts) { return counts.both_empty() ? 0 : 1 - iou(counts); }

std::vector<std::size_t> SceneProbe::sample_views() const { return spread_views(problem_.views, kDecisionViews); }
std::vector<Camera> SceneProbe::sample_cameras() const { return cameras_of(problem_.scene, sample_views()); }
double SceneProbe::views_with_photo() const { return double(photo_count(problem_.scene, problem_.views)); }

bool SceneProbe::stopped() const { return stop_requested(problem_.monitor); }

const LabelViews& SceneProbe::label_views() {
  if (!views_) views_ = label_views_of(problem_.views);
  return *views_;
}

const LabelViews& SceneProbe::label_sample() {
  constexpr std::size_t kSampleViews = 24;
  if (!sample_) sample_ = label_views_of(spread_views(problem_.views, kSampleViews));
  return *sample_;
}

LabelViews SceneProbe::label_views_of(const std::vector<std::size_t>& some) {
  LabelViews views;
  const LabelChannels label(exec_, problem_.cloud, problem_.labels);
  std::size_t count = 0;
  for_each_view(problem_.monitor, some, [&](std::size_t, std::size_t v) {
    const ViewMasks masks = problem_.load_masks(v);
    if (!masks.available) return;
    const ImageF rendered = label.view(exec_, problem_.scene.views[v].camera, problem_.splat);
    count += add_view(exec_, rendered, masks, views);
  });
  if (count > 0) views.biou /= double(count);
  return views;
}

double SceneProbe::edge_gain() {
  if (edge_gain_) return *edge_gain_;
  edge_gain_ = 0;
  if (!problem_.load_fine_photo) return 0;
  const std::vector<std::size_t> all = spread_views(problem_.views, kComparedViews);
  std::vector<RefinedView> refined(problem_.scene.views.size());
  const auto refine = [&](const std::vector<std::size_t>& views) {
    std::vector<RefinedView> more = refine_views(exec_, {ContourRefineOptions{}, kMargin_px, problem_},
                                                 {problem_.cloud, problem_.labels}, views, views);
    for (const std::size_t v : views) refined[v] = std::move(more[v]);
  };
  const std::vector<std::size_t> few = spread_views(all, kPhotoViews);
  refine(few);
  if (!explains_photos(exec_, problem_, {problem_.cloud, problem_.labels}, refined)) return 0;
  const std::vector<std::size_t> first = without(spread_views(all, kFirstComparedViews), few);
  refine(first);
  edge_gain_ = mask_agreement_gain(refined);
  if (*edge_gain_ < -kClearScore || stopped()) return *edge_gain_;
  refine(without(without(all, few), first));
  return edge_gain_.emplace(mask_agreement_gain(refined));
}

const BoundarySet& SceneProbe::boundary() {
  if (boundary_) return *boundary_;
  std::vector<float> flags(std::size_t(problem_.cloud.size()), 0.f);
  for (const LabelColumns& object : problem_.labels)
    for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = std::max(flags[i], object.boundary[i]);
  return boundary_.emplace(boundary_set(problem_.cloud, flags));
}

Rows<const float, 3> SceneProbe::boundary_colours() { return {boundary().colour.data(), boundary().size()}; }

const KnnGraph& SceneProbe::boundary_neighbours() {
  if (neighbours_) return *neighbours_;
  neighbours_.emplace();
  if (boundary().size() > 1) neighbours_ = nearest_others(exec_, boundary().positions(), training_.rbf.neighbours);
  return *neighbours_;
}

}  // namespace ngs
