#pragma once
// By how much an image has to be moved to lie on another one: Lucas and Kanade's least squares for a
// translation, with Cauchy weights, so that what only one of the two shows does not pull.
#include "ngs/scene/views.h"

namespace ngs {

struct ImageShift {
  double dx_px = 0, dy_px = 0;               // moving(x - d) is nearest to still(x)
  double error_before = 0, error_after = 0;  // mean of log(1 + r² / s²) over the pixels that count
  bool converged = false;                    // false: no texture, or the steps did not settle
};

inline constexpr double kShiftResidual = 0.05;  // s: residuals above it count less

/// Images of one size with C channels in [0, 1]; `weight` [H, W, 1] in [0, 1], of the moving image. Both are
/// smoothed by a 5x5 binomial first. Serial.
ImageShift find_shift(const ImageF& moving, const ImageF& still, const ImageF& weight);

}  // namespace ngs
