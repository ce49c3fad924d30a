#pragma once
// Agreement of a solution's rendered masks with the training views' masks.
#include <vector>

#include "ngs/problem/problem.h"

namespace ngs {

/// IoU and boundary IoU of one view, means over the objects. The boundary band is 0.005 of the image diagonal.
struct Agreement {
  double iou = 0, biou = 0;
};

/// One entry per training view that has masks; of at most `most_views` training views, 0: of all.
std::vector<Agreement> training_agreement(const Exec& exec, const Problem& problem, const Solution& solution,
                                          std::size_t most_views = 0);
Agreement mean_agreement(const std::vector<Agreement>& views);

struct AgreementTarget {
  bool boundary;  // the value is a boundary IoU, else an IoU
  double value;   // in [0, 1]
};
}  // namespace ngs
