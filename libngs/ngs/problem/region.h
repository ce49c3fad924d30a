#pragma once
// The region of an object: the rows of a model that may change. A scene has millions of Gaussians, an object thousands.
// All rows outside the region keep their bytes.                                                     paper.md §5.16
#include "ngs/problem/problem.h"

namespace ngs {

/// Minimum share of object evidence of a Gaussian in the region: the smallest start value of soft labels
/// (1 - kMaxInitialConfidence of cut/training/trained_labels.h). A smaller share is the error of the masks' contours.
inline constexpr float kMinRegionShare = 0.01f;

/// True: the row is in the object's region: prob of at least kMinRegionShare, labelled, or boundary.
bool in_region(const LabelColumns& object, std::size_t row);

/// [N] 1: the row is in the region of some object.
std::vector<std::uint8_t> region_of(const std::vector<LabelColumns>& labels);

/// [N] 1: some mask of some object covers the Gaussian (prob > 0).
std::vector<std::uint8_t> rows_with_foreground_evidence(const std::vector<LabelColumns>& labels);

/// Copies every row that is in neither the region of `given` nor the region of `labels` from `given` to `labels`. Both
/// must belong to the same model.
void restore_outside_regions(const std::vector<LabelColumns>& given, std::vector<LabelColumns>& labels);

/// The number of rows of the solution that differ in some bit from their row of the input model and labels. Added rows
/// count; removed rows do not.
std::int64_t rows_changed(const GaussianCloud& cloud, const std::vector<LabelColumns>& labels,
                          const Solution& solution);

}  // namespace ngs
