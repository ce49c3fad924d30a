#pragma once
// Which masks the other masks contradict.                                                     PAPER.md §5.9
//
// Every view's mask is compared with the consensus of the others: labels from the evidence of all trusted views but
// this one, rendered into it, once as the model stands (modal) and once with the object alone (amodal; what hides the
// object may be a floater). The better of the two counts. A view that disagrees far more than the median view is
// ignored; the median is that of the views where mask or consensus shows an object.
//
// Of many masks one vote changes little: there a first look compares each with the labels as they come, its own vote
// among them, and only views that come to half of the threshold are asked what the others say.
#include "ngs/problem/problem.h"

namespace ngs {

struct MaskOutlierOptions {
  int least_views = 4;  // with fewer masks, or fewer that show an object, there is no consensus
  double factor = 3;    // ignored: 1 - IoU above this many medians,
  double spreads = 6;   // above the median by this many standard deviations (1.4826 MAD),
  double least = 0.2;   // and above this;
  double most = 0.9;    // above this at any rate, where most views share more than half with the others
  int rounds = 3;       // the consensus without the ignored views judges again
};

/// The disagreement above which a view is ignored, from those of all views (at least one). `median`: of them.
double ignore_threshold(const MaskOutlierOptions& options, const std::vector<double>& disagreement, double& median);

/// How far the worst view stands out, in units of half the distance at which it would be ignored; 0 for fewer than two
/// views. Not the worst disagreement: of a thin object all views disagree alike.
double outlier_score(const std::vector<double>& disagreement);

struct MaskOutliers {
  std::vector<std::size_t> ignored;       // indices of scene.views, ascending
  std::vector<double> disagreement;       // per entry of input.views: 1 - IoU with the others; negative: no mask
  std::map<std::string, double> figures;  // median, threshold, rounds
};

/// From as many views on there is a first look.
inline constexpr std::size_t kManyVotes = 32;

/// Per entry of input.views: 1 - IoU of its mask with the labels of the input, of all objects drawn alone, or of the
/// model as it stands where that is better and the first does not show already that the mask agrees (half of
/// MaskOutlierOptions::least); negative: there is no mask, or neither shows any object. Empty with fewer than
/// kManyVotes views, without labels, or where it was asked to stop.
std::vector<double> first_look(const Exec& exec, const MaskOutlierOptions& options, const Problem& input);

/// `first`: of first_look(); empty: every view is asked.
MaskOutliers judge_views(const Exec& exec, Monitor& monitor, const MaskOutlierOptions& options, const Problem& input,
                         const std::vector<double>& first = {});

/// The masks of a view; not available where it is ignored.
ViewMasks consistent_masks(const MaskOutliers& trust, std::size_t view, ViewMasks masks);

}  // namespace ngs
