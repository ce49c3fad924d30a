#pragma once
// Views without a photo, in contour iterations.                                                 paper.md §5.10
//
// Nothing constrains a view without a photo in an iteration, so its rendering drifts. The rendering before the
// iterations can replace the photo, and contours are refined to its edges. This helps if the rendering is as good as a
// photo, and keeps a poor model from improving. A trial on views with a photo decides: a few of them, the trial views,
// are excluded from an iteration whose result is discarded. Two sets of their contours are compared with the contours
// refined in their photos: those refined in their renderings, and those that the model renders after the iteration.
#include <vector>

#include "ngs/cut/contours/refined_masks.h"

namespace ngs {

/// The trial views: every third of the views, from the second on. Empty for fewer than five views, which would give
/// fewer than two trial views.
std::vector<std::size_t> trial_views_of(const std::vector<std::size_t>& views);

/// The input with the photos of the given views replaced by renderings of `cloud`. Renderings are cached up to
/// `cache_bytes`. Views that do not fit are rendered at every load from a copy of the model; loading is thread-safe.
/// The objects that `input` refers to must outlive the result; `cloud` need not.
Problem with_renderings(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                        const std::vector<std::size_t>& views, std::size_t cache_bytes = 256u << 20);

struct Trial {
  double pictured = 0, skipped = 0;  // mean boundary IoU (0.005) with the contours refined in the photos
  bool renderings_help = false;      // `pictured` exceeds `skipped` by more than two standard errors
};

/// The iteration of the trial: the model before it and after it.
struct TrialIteration {
  LabelledModel before, after;
};

/// `in_photos` [scene views]: the trial views refined in their photos, from the labels before the iteration.
/// `trial_views`: the trial views.
Trial evaluate_trial(const Exec& exec, const RefineSetup& setup, const TrialIteration& iteration,
                     const std::vector<RefinedView>& in_photos, const std::vector<std::size_t>& trial_views);

}  // namespace ngs
