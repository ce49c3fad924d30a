#pragma once
// Finds masks that contradict the other masks.                                                paper.md §5.9
//
// Each view's mask is compared with the consensus of the others: labels from the evidence of all other inlier views,
// rendered into the view. The consensus is rendered twice, with the whole model (modal) and with the object alone
// (amodal), because the occluder may be a floater. The better agreement counts. A view is an outlier if it disagrees
// far more than the median view. Views in which neither mask nor consensus shows an object do not enter the median.
//
// With many masks, one mask changes the labels little. A pretest then compares each mask with the closed-form labels of
// all masks. Only views that reach half of the threshold in the pretest are compared with the consensus of the others.
#include "ngs/problem/problem.h"

namespace ngs {

/// The threshold above which a view is an outlier. `disagreement`: of all views, at least one. Sets `median` to theirs.
double ignore_threshold(const std::vector<double>& disagreement, double& median);

/// The largest disagreement relative to half of the outlier threshold; 0 for fewer than two views. The largest
/// disagreement alone would not do: with a thin object all views disagree alike.
double outlier_score(const std::vector<double>& disagreement);

struct MaskOutliers {
  std::vector<std::size_t> ignored;       // indices of scene.views, ascending
  std::vector<double> disagreement;       // per entry of input.views: 1 - IoU with the consensus; negative: no mask
  std::map<std::string, double> figures;  // median, threshold, rounds
};

inline constexpr std::size_t kPretestViews = 32;

/// Compares each mask with the input's labels. Per entry of input.views: 1 - IoU with all objects rendered alone; if
/// that exceeds half of the least disagreement of an outlier, the smaller of it and 1 - IoU with the whole model.
/// Negative: the view has no mask, or neither shows any object. Empty with fewer than kPretestViews views, without
/// labels, or if a stop was requested.
std::vector<double> pretest_masks(const Exec& exec, const Problem& input);

/// `pretest`: result of pretest_masks(); empty: every view is tested.
MaskOutliers find_mask_outliers(const Exec& exec, Monitor& monitor, const Problem& input,
                                const std::vector<double>& pretest = {});

/// The masks of a view, marked as not available if the view is an outlier.
ViewMasks consistent_masks(const MaskOutliers& outliers, std::size_t view, ViewMasks masks);

}  // namespace ngs
