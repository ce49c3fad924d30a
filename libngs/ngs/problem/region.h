#pragma once
// The rows of a model that an object concerns. A scene has millions of Gaussians, an object thousands: whatever an
// optimiser would make of the others, they are not its business, and keep their bytes.              PAPER.md §5.16
#include "ngs/problem/problem.h"

namespace ngs {

/// Share of the masks' evidence from which on a Gaussian is of the region: what soft labels start from at least
/// (1 - kMaxInitialConfidence of stages/optimise/label_start.h); below it a mask's weight is its contour's error.
inline constexpr float kLeastRegionShare = 0.01f;

/// Whether a row is of an object's region: partly the object's (prob of at least kLeastRegionShare), labelled, or
/// boundary.
bool in_region(const LabelColumns& object, std::size_t row);

/// [N] 1: of some object's region.
std::vector<std::uint8_t> region_of(const std::vector<LabelColumns>& labels);

/// [N] 1: masks say that it is some object's, however little of it.
std::vector<std::uint8_t> claimed_rows(const std::vector<LabelColumns>& labels);

/// Takes from `given` the rows that are of neither's region, column by column. Both of the same model.
void keep_outside(const std::vector<LabelColumns>& given, std::vector<LabelColumns>& labels);

/// How many rows of a solution are not, bit for bit, rows of the model and labels that it was made of. Rows that were
/// added count, rows that are missing do not.
std::int64_t rows_changed(const GaussianCloud& cloud, const std::vector<LabelColumns>& labels,
                          const Solution& solution);

}  // namespace ngs
