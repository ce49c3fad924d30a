#pragma once
// Views without a photo, in contour iterations.                                                 PAPER.md §5.10
//
// No photo of an iteration holds what such a view shows, and it drifts. What the model showed there before the
// iterations could stand in for the photo: its picture is kept, and its contours are refined to the picture's edges.
// That serves where the picture is as good as a photo, and holds a poor model back. Which it is can be tried on views
// that have a photo: a few of them, the judges, are left out of an iteration that is forgotten after. Their contours as
// refined in the photo are compared with those as refined in the picture, and with those that the model draws after
// that iteration.
#include <vector>

#include "ngs/stages/contours/refined_masks.h"

namespace ngs {

/// Every third of the views from the second on; none of fewer than five, which would leave less than two judges.
std::vector<std::size_t> judges_of(const std::vector<std::size_t>& views);

/// The input with the model's picture of the given views in place of their photos. Pictures are kept up to
/// `cache_bytes`; where that is too little a copy of the model is, of which the others are drawn whenever they are asked
/// for, by several threads at once if need be. What `input` refers to must outlive the result, `cloud` need not.
Problem with_pictures(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                      const std::vector<std::size_t>& views, std::size_t cache_bytes = 256u << 20);

struct Trial {
  double pictured = 0, skipped = 0;  // mean boundary IoU (0.005) with the contours as refined in the photos
  bool picture_serves = false;       // pictured is higher by more than twice the standard error
};

/// An iteration that is forgotten after: the model before it, and what it made of it.
struct TriedIteration {
  LabelledModel before, after;
};

/// `in_photos`: the judges as refined in their photos before the first iteration, from the labels before it. [scene
/// views]
Trial try_pictures(const Exec& exec, const RefineSetup& setup, const TriedIteration& tried,
                   const std::vector<RefinedView>& in_photos, const std::vector<std::size_t>& judges);

}  // namespace ngs
