#pragma once
// ngs-joint --method bce: the labels that minimise the mask loss, with fixed geometry.    Eq. (19); C18 (a)
//
// The problem is convex. The solver starts from the closed form and stops at a certified duality gap
// (ops/labels/label_solve.h). Figures of the result: loss, gap, relative_gap, evaluations, rounds, columns,
// working_columns, cache_mib, streamed_views. The last three are those of the largest working set. With several
// objects each figure's name ends with the object's name.
#include "ngs/ops/labels/label_solve.h"
#include "ngs/options/field.h"
#include "ngs/problem/problem.h"

namespace ngs {

struct BceOptions {
  double relative_gap = 1e-3;
  int max_evaluations = 2000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.relative_gap,
          Field<double>{"bce_gap", "of the loss", "Stop at this duality gap (bound on loss - optimum)", 1e-6, 1.0});
    visit(self.max_evaluations, Field<int>{"bce_evaluations", "", "Maximum number of loss evaluations", 1, 1000000});
  }
};

struct BceResult {
  Solution method;
  std::vector<std::vector<GapPoint>> trace;  // per object: loss and gap over time
};

BceResult solve_bce(const Exec& exec, Monitor& monitor, const BceOptions& options, const Problem& input);

}  // namespace ngs
