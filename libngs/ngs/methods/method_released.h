#pragma once
// ngs-joint --method released: what the authors' published code does.                       PAPER.md §6.5
//
// COB-GS (method cob, with the code's own divisor) plus a colour regulariser in the texture phases. For
// comparison only: the regulariser sees no ray, no query point and no mask, it acts on the colours of the
// 4096 Gaussians with the most undecided labels, and rendering masks does not read colours. What the paper
// describes is --method ng-gs.
#include "ngs/methods/method_cob.h"
#include "ngs/options/field.h"

namespace ngs {

struct ReleasedOptions {
  CobOptions cob;  // the --cob-* flags; its divisor is not read
  int count = 4096;
  double align = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.count,
          Field<int>{"released_count", "", "Gaussians that are regularised, most undecided first", 0, 1 << 20});
    visit(self.align,
          Field<double>{"released_align", "", "weight of the distance to the neighbours' mean colour", 0.0, 1e6});
  }
};

/// Rows of the cloud by 4 m (1 - m), m the sigmoid of the most undecided object's logit [N, K]; ties by row.
/// At most `count`, ascending; unusable rows are left out.
std::vector<std::size_t> most_undecided(const GaussianCloud& cloud, const std::vector<float>& logit, int count);

Solution run_released(const Exec& exec, Monitor& monitor, const ReleasedOptions& options, const Problem& input);

}  // namespace ngs
