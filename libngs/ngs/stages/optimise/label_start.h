#pragma once
// Where the soft labels of the joint steps start (PAPER.md §5.4).
#include <algorithm>

#include "ngs/math/stable.h"

namespace ngs {

inline constexpr double kMaxInitialConfidence = 0.99;  // sigmoid logits can move away from it

/// Log-odds that `steps` steps of EM on the mask loss (§5.3) make of labels of 1/2. The first makes the share f of the
/// evidence; where the rendered mask is about f around the Gaussian, every further one adds ln(f / (1 - f)).
inline double start_log_odds(double share, int steps) {
  const double most = logit(kMaxInitialConfidence);
  return std::clamp(steps * logit(std::clamp(share, 1 - kMaxInitialConfidence, kMaxInitialConfidence)), -most, most);
}

}  // namespace ngs
