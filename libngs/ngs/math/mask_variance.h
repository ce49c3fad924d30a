#pragma once
// Eq. (3), normalised (C1, C2).

namespace ngs {

/// Variance in [0, 1] of binary mask values of which a share f is 1: 4 f (1 - f).
inline double mask_variance(double share) { return 4.0 * share * (1.0 - share); }

}  // namespace ngs
