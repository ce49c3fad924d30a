#pragma once
// Splits Gaussians that straddle the contour of a mask, so that geometry and labels can follow the contour.
#include <cstdint>
#include <vector>

#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/evidence.h"

namespace ngs {

/// Rendering weight of every Gaussian on both sides of the masks' contours.
struct Straddling {
  // [N] Weight on the wrong side: Σ_views min(W1, W - W1) with the weights W1 inside the mask and W in total, of the
  // object with the largest value; 0 for a Gaussian that no contour crosses.
  std::vector<double> px;
  ExactSums weight;  // [N] W, summed over the views
  Evidence last;     // evidence of the last rows, summed over the views
};
/// Gathers evidence only for the last `last_rows` rows: with many objects, evidence of all rows needs more memory than
/// the model.
Straddling straddling(const Exec& exec, const Problem& input, const GaussianCloud& cloud, std::int64_t last_rows);

/// Rows of a cloud in which at most `most` Gaussians, those with the largest values above `least_px`, are halved. The
/// other rows keep their order; the halves follow in pairs.
std::vector<CloudRow> split_straddlers(const std::vector<double>& straddling_px, double least_px, std::int64_t most);

}  // namespace ngs
