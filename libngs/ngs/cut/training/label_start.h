#pragma once
// Start values of the soft labels of the joint steps (paper.md §5.4).
#include <algorithm>

#include "ngs/math/stable.h"

namespace ngs {

inline constexpr double kMaxInitialConfidence = 0.99;  // bound on start labels, so that the sigmoid has a gradient

/// Log-odds after `steps` EM steps on the mask loss (§5.3) from labels of 1/2. The first step gives the share f of the
/// evidence. If the rendered mask is about f near the Gaussian, every further step adds ln(f / (1 - f)).
inline double start_log_odds(double share, int steps) {
  const double most = logit(kMaxInitialConfidence);
  return std::clamp(steps * logit(std::clamp(share, 1 - kMaxInitialConfidence, kMaxInitialConfidence)), -most, most);
}

}  // namespace ngs
