#pragma once
// ngs-joint --method released: the algorithm of the authors' published code.                 paper.md §6.5
//
// COB-GS (method cob, divided by all views) plus a colour regulariser in the texture phases. For comparison only:
// the regulariser uses no ray, query point or mask. It changes the colours of the 4096 Gaussians with the most
// uncertain labels, and rendered masks do not depend on colours. --method ng-gs is the method of the paper.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/cut/methods/method_cob.h"
#include "ngs/options/field.h"

namespace ngs {

// The colour regulariser of the authors' released code, oddities included.                 paper.md §6.5
//
// A network refines the constant (SH degree 0) colours of at most 4096 Gaussians. Its 8 hash levels of 2 features are
// looked up at the floor cell without interpolation, with composite numbers in place of primes, in coordinates
// normalised by the minimum and maximum of each batch. Two layers follow, with one modulation by the colour itself:
// rgb = clamp(base + 0.1 tanh). The output is used only in the losses below; no ray, pixel or mask takes part.
// Arithmetic is in double, so that tests can check the gradient.

struct ReleasedWeights {
  double align = 1, continuity = 0.1, smooth = 0.05, density = 1e-3;
};

struct ReleasedRows {
  const std::vector<float>& position;  // [M, 3] world
  const std::vector<double>& base;     // [M, 3] colours in [0, 1]
};

struct ReleasedLosses {
  double align = 0, continuity = 0, smooth = 0, density = 0, total = 0;
};

class ReleasedField {
 public:
  explicit ReleasedField(std::uint64_t seed);

  /// Losses of M Gaussians and their gradients. Overwrites `grad_base` [M, 3] and grad(). `draw` is the number of the
  /// step, the jitter's random counter. Gradients stop where the published code detaches.
  ReleasedLosses evaluate(const Exec& exec, const ReleasedWeights& weights, const ReleasedRows& in, std::uint64_t draw,
                          std::vector<double>& grad_base);
  /// One Adam step of the network and the hash tables along grad().
  void step(const Exec& exec, double lr);

  std::vector<double>& parameters() { return value_; }
  const std::vector<double>& grad() const { return grad_; }

 private:
  std::vector<double> value_, grad_, m_, v_;
  std::uint64_t seed_;
  std::int64_t steps_ = 0;
};

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
