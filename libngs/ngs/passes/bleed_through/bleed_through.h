#pragma once
// Labels that Gaussians have only because they show through the object.                          PAPER.md §5.17
//
// What lies under the object or behind it shows through it a little in every view that looks at it across the object,
// all of that within the mask. Where few views see it in the open, these traces are most of its weight. By visibility
// they are not:
//   f_T = Σ α T² M / Σ α T²     where the closed form is     f = Σ α T M / Σ α T     (T: what is left of the light)
// A Gaussian that is labelled as the object and has f_T < 1/2 loses the label where the masks vote for that: object by
// object, by the squared error of both labels drawn against the mask.
#include <cstdint>
#include <vector>

#include "ngs/problem/problem.h"

namespace ngs {

struct BleedThrough {
  struct OfObject {
    std::int64_t found = 0;  // Gaussians with f_T < 1/2
    double gain = 0;         // of agreement with the masks without them, standard errors of the mean over the views
    bool taken = false;      // they have lost the label
  };
  std::vector<LabelColumns> labels;
  std::vector<OfObject> objects;
};

/// `labels`: the problem's, which become those of the finding. Rows fixed by hand stay, as does what no view shows.
/// Where it was asked to stop, nothing is taken.
BleedThrough without_bleed_through(const Exec& exec, const Problem& problem, std::vector<LabelColumns> labels);

}  // namespace ngs
