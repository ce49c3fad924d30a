#pragma once
// Removes labels of Gaussians that are only visible through the object.                          paper.md §5.17
//
// A Gaussian behind the object shows through it faintly in many views, always within the mask. If few views see the
// Gaussian unoccluded, these faint contributions are most of its rendering weight. Weighting by visibility suppresses
// them:
//   f_T = Σ α T² M / Σ α T²     instead of the closed form     f = Σ α T M / Σ α T     (T: transmittance, M: mask)
// Gaussians that are labelled as an object and have f_T < 1/2 lose the label if this reduces the squared error of the
// rendered label against the masks significantly. Each object is tested separately.
#include <cstdint>
#include <vector>

#include "ngs/problem/problem.h"

namespace ngs {

struct BleedThrough {
  struct OfObject {
    std::int64_t found = 0;  // Gaussians with f_T < 1/2
    double gain = 0;         // gain in agreement with the masks without them, in standard errors of the mean over views
    bool taken = false;      // true: these Gaussians lost the label
  };
  std::vector<LabelColumns> labels;
  std::vector<OfObject> objects;
};

/// `labels`: those of the problem; returned with the changes. Rows fixed by hand and Gaussians that no view shows keep
/// their labels. If a stop is requested, no label is removed.
BleedThrough without_bleed_through(const Exec& exec, const Problem& problem, std::vector<LabelColumns> labels);

}  // namespace ngs
