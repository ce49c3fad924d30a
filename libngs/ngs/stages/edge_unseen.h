#pragma once
// Views without a photo, in the rounds of edges.                                                  PAPER.md §5.10
//
// No photo of a round holds what such a view shows, and it drifts. What the model showed there before the rounds could stand
// in for the photo: its picture is kept, and its contours are walked to the picture's edges. That serves where the picture is
// as good as a photo, and holds a poor model back. Which it is can be tried on views that have a photo: a few of them, the
// judges, are left out of a round that is forgotten after. Their contours as walked in the photo are compared with those as
// walked in the picture, and with those that the model draws after that round.
#include <vector>

#include "ngs/stages/edge_masks.h"

namespace ngs {

/// Every third of the views from the second on; none of fewer than five, which would leave less than two judges.
std::vector<std::size_t> judges_of(const std::vector<std::size_t>& views);

/// The input with the model's picture of the given views in place of their photos. Pictures are kept up to `kept_bytes`; where
/// that is too little a copy of the model is, of which the others are drawn whenever they are asked for, by several threads at
/// once if need be. What `input` refers to must outlive the result, `cloud` need not.
MethodInput with_pictures(const Exec& exec, const MethodInput& input, const GaussianCloud& cloud, const std::vector<std::size_t>& views,
                          std::size_t kept_bytes = 256u << 20);

struct Trial {
  double pictured = 0, unseen = 0;  // mean boundary IoU (0.005) with the contours as walked in the photos
  bool picture_serves = false;      // pictured is higher by more than twice the standard error
};

/// `in_photos`: the judges as walked in their photos before the first round, from the labels of `before`; `after`: what the round
/// has made of it. [scene views]
Trial try_pictures(const Exec& exec, const WalkSetup& setup, const LabelledModel& before, const LabelledModel& after,
                   const std::vector<WalkedView>& in_photos, const std::vector<std::size_t>& judges);

}  // namespace ngs
