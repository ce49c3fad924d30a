#pragma once
// Splits Gaussians that straddle the contour of a mask, so that geometry and labels can follow the contour.
#include <cstdint>
#include <vector>

#include "ngs/math/row_numbers.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/evidence.h"

namespace ngs {

/// Rendering weight of Gaussians on both sides of the masks' contours, summed over the views.
struct Straddling {
  // [rows] Weight on the wrong side: Σ_views min(W1, W - W1) with the weights W1 inside the mask and W in total, of the
  // object with the largest value; 0 for a Gaussian that no contour crosses.
  std::vector<double> px;
  ExactSums weight;   // [rows] W
  Evidence evidence;  // [rows] with `of`; of all rows of many objects it would need more memory than the model
};
/// Of all Gaussians or, with `of`, of these only: views are rendered only where they show.
Straddling straddling(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                      const RowNumbers* of = nullptr);

/// Rows of a cloud in which the Gaussians with values above `least_px` are halved. The other rows keep their order; the
/// halves follow in pairs.
std::vector<CloudRow> split_straddlers(const std::vector<double>& straddling_px, double least_px);

}  // namespace ngs
