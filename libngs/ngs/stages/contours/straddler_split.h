#pragma once
// Splitting Gaussians that lie across the contour of a mask, so that geometry and labels can follow it.
#include <cstdint>
#include <vector>

#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/evidence.h"

namespace ngs {

/// What every Gaussian draws on either side of the masks.
struct Straddling {
  std::vector<double> px;  // [N] on the wrong side: Σ_views min(W1, W - W1), its weight inside and outside of the mask,
                           // of the object where that is largest; 0 for a Gaussian that no contour crosses
  ExactSums weight;  // [N] in all views together
  Evidence last;     // of the last rows, object by object, in all views together
};
/// Evidence is gathered of the last `last_rows` rows alone: with many objects that of all takes more than the model.
Straddling straddling(const Exec& exec, const Problem& input, const GaussianCloud& cloud, std::int64_t last_rows);

/// Rows of a cloud in which the Gaussians with more than `least_px` are halved (at most `most` of them, the
/// worst first). Kept rows stay in order, then come the halves, pair by pair.
std::vector<CloudRow> split_straddlers(const std::vector<double>& straddling_px, double least_px, std::int64_t most);

}  // namespace ngs
