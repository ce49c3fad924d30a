#pragma once
// ngs-joint --method bce: the labels that explain the masks best, geometry fixed.       Eq. (19); C18 (a)
//
// Convex: started from the closed form, solved to a certified gap (ops/labels/label_solve.h). Figures of the result,
// each with the object's name appended where there are several: loss, gap, relative_gap, evaluations, rounds,
// columns, working_columns, cache_mib, streamed_views (the last three: of the largest working set).
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
          Field<double>{"bce_gap", "of the loss", "stop at this duality gap (bound on loss - optimum)", 1e-6, 1.0});
    visit(self.max_evaluations,
          Field<int>{"bce_evaluations", "", "at most this many evaluations of the loss", 1, 1000000});
  }
};

struct BceResult {
  Solution method;
  std::vector<std::vector<GapPoint>> trace;  // per object: loss and gap over time
};

BceResult solve_bce(const Exec& exec, Monitor& monitor, const BceOptions& options, const Problem& input);
Solution run_bce(const Exec& exec, Monitor& monitor, const BceOptions& options, const Problem& input);

}  // namespace ngs
