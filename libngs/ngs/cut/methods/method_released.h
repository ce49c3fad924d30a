#pragma once
// ngs-joint --method released: the algorithm of the authors' published code.                 paper.md §6.5
//
// COB-GS (method cob, divided by all views) plus a colour regulariser in the texture phases. For comparison only:
// the regulariser uses no ray, query point or mask. It changes the colours of the 4096 Gaussians with the most
// uncertain labels, and rendered masks do not depend on colours. --method ng-gs is the method of the paper.
#include "ngs/cut/methods/method_cob.h"
#include "ngs/options/field.h"

namespace ngs {

struct ReleasedOptions {
  CobOptions cob;  // the --cob-* flags; its divisor is not read
  int count = 4096;
  double align = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.count,
          Field<int>{"released_count", "", "Number of Gaussians to regularise, most uncertain first", 0, 1 << 20});
    visit(self.align,
          Field<double>{"released_align", "", "Weight of the distance to the neighbours' mean colour", 0.0, 1e6});
  }
};

/// The at most `count` usable rows with the largest 4 m (1 - m), where m is the sigmoid of the row's logit [N, K] of
/// least absolute value. Ties go to the lower row. Returned in ascending order.
std::vector<std::size_t> most_undecided(const GaussianCloud& cloud, const std::vector<float>& logit, int count);

Solution run_released(const Exec& exec, Monitor& monitor, const ReleasedOptions& options, const Problem& input);

}  // namespace ngs
