#pragma once
// Where the soft labels of the joint steps start (PAPER.md §5.4).
#include <algorithm>

#include "ngs/math/stable.h"

namespace ngs {

inline constexpr double kMaxInitialConfidence = 0.99;  // sigmoid logits can move away from it

/// The share f of a Gaussian's evidence is what one step of EM on the mask loss (§5.3) makes of labels of 1/2. Where the
/// rendered mask is about f around the Gaussian, every further step adds ln(f / (1 - f)) to its log-odds.
inline constexpr int kStartSteps = 3;

/// Log-odds that `steps` such steps make of the share.
inline double start_log_odds(double share, int steps) {
  const double most = logit(kMaxInitialConfidence);
  return std::clamp(steps * logit(std::clamp(share, 1 - kMaxInitialConfidence, kMaxInitialConfidence)), -most, most);
}

}  // namespace ngs
