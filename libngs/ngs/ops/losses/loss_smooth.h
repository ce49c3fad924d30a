#pragma once
// L_smth: the field's colour changes slowly in space.                                 Eq. (18); D14
//
//   L = 3 (u/h)² · 1/N Σ_i ‖c(x_i + h n_i) - c(x_i)‖²,   n_i random unit vectors
//
// An unbiased estimate, for small h, of the mean of Σ_channels ‖u ∇c‖², from two colours per point: E (n·g)² = ‖g‖²/3.
// u is the unit of length in which the gradient counts (the RBF width), so the loss does not depend on the unit of the
// scene. No second derivatives; the caller evaluates the field at both ends of every pair. No pairs: loss 0.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs {

struct SmoothnessScale {
  double pair_length = 0;  // > 0, world
  double unit_length = 0;  // u > 0, world
};

/// One pair of points per sample, [N, 3] each. The loss penalises the colour difference of a pair.
struct SmoothnessPairs {
  std::vector<float> from, to;
  double length = 0;  // of a pair, world
};

/// Selects the random vectors of a step: `first_index` must differ between steps (for example step · points).
struct SmoothnessDraw {
  std::uint64_t seed = 0, first_index = 0;
};

/// `step_length` h > 0, world.
SmoothnessPairs smoothness_pairs(const Exec& exec, Rows<const float, 3> points, double step_length,
                                 const SmoothnessDraw& draw);

/// Colours of the field at both ends of the pairs, [N, 3] each.
struct SmoothnessInputs {
  const std::vector<float>&colour, &moved_colour;
};

struct SmoothnessGradients {
  std::vector<float> colour, moved_colour;  // [N, 3]
};

/// The loss; `out` is overwritten with weight · its gradients.
double loss_smooth_backward(const Exec& exec, const SmoothnessScale& scale, const SmoothnessInputs& in, double weight,
                            SmoothnessGradients& out);

}  // namespace ngs
