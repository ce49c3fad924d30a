#pragma once
// L_smth: the field's colour changes slowly in space.                                 Eq. (18); D14
//
//   L = 3 (u/h)² · 1/N Σ_i ‖c(x_i + h n_i) - c(x_i)‖²,   n_i random unit vectors
//
// For small h this is an unbiased estimate of the mean of Σ_channels ‖u ∇c‖²: E (n·g)² = ‖g‖²/3. u is the
// unit of length in which the gradient counts (the RBF width), so the loss does not depend on the unit of the
// scene. It needs no second derivatives; the caller evaluates the field at both sets of points. No points:
// loss 0.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs {

struct SmoothnessScale {
  double jitter_length = 0;  // h > 0, world
  double unit_length = 0;    // u > 0, world
};

/// x_i + h n_i. `first_index` (for example step · points) makes the vectors of every step different.
std::vector<float> jittered_points(const Exec& exec, Rows<const float, 3> points, std::uint64_t seed,
                                   std::uint64_t first_index, double jitter_length);

/// Colours of the field at the points and at the jittered ones, [N, 3] each.
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
