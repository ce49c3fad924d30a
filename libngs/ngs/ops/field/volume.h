#pragma once
// Colour, alpha and optical depth of rays through the field.                              Eq. (1)
//
// The background shows where the field is transparent, so the colours compare with a rendered view over the
// same background (C15). K = 0 samples: the background, alpha 0. Does not depend on exec.threads.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/math/vec.h"

namespace ngs {

struct VolumeInputs {
  int samples = 0;                 // K
  const float* density = nullptr;  // [R, K]    world^-1
  const float* rgb = nullptr;      // [R, K, 3]
  const float* spacing = nullptr;  // [R]       world, RayQueries::spacing
  std::int64_t rays = 0;           // R
  Vec3<float> background{0, 0, 0};
};

struct VolumeOutput {
  std::vector<float> colour;                       // [R, 3]
  std::vector<float> alpha;                        // [R]
  std::vector<float> optical_depth;                // [R] Σ σ Δ, unit-free (C19)
  std::vector<float> weight, transmittance_after;  // [R, K] for backward
};

struct VolumeGradients {
  std::vector<float> density;  // [R, K]
  std::vector<float> rgb;      // [R, K, 3]
};

void volume_forward(const Exec& exec, const VolumeInputs& in, VolumeOutput& out);

/// Overwrites `out`. `grad_optical_depth` may be empty (zero).
void volume_backward(const Exec& exec, const VolumeInputs& in, const VolumeOutput& forward,
                     const std::vector<float>& grad_colour, const std::vector<float>& grad_alpha,
                     const std::vector<float>& grad_optical_depth, VolumeGradients& out);

}  // namespace ngs
