#pragma once
// Inputs, outputs and gradients of volume rendering (ops/field/volume.h).                 Eq. (1)
#include <cstdint>
#include <vector>

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

/// ∂L/∂(VolumeOutput).
struct VolumeOutputGradients {
  const std::vector<float>& colour;         // [R, 3]
  const std::vector<float>& alpha;          // [R]
  const std::vector<float>& optical_depth;  // [R], or empty: zero
};

struct VolumeGradients {
  std::vector<float> density;  // [R, K]
  std::vector<float> rgb;      // [R, K, 3]
};

}  // namespace ngs
