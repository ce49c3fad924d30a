#pragma once
// Inputs, outputs and gradients of the ops of the field.
#include <cstdint>
#include <vector>

#include "ngs/math/vec.h"
#include "ngs/scene/knn_graph.h"
#include "ngs/scene/views.h"

namespace ngs {

// The FiLM network (ops/field/film_mlp.h). Eqs. (12)-(15)
struct FilmMlpInputs {
  Matrix<const float> feature;     // [Q, inputs]    f_hash
  Matrix<const float> condition;   // [Q, condition] f_inter
  Rows<const float, 3> direction;  // [Q / queries_per_direction, 3] unit; unused if direction_degree = 0
  std::int64_t queries_per_direction = 1;
};

struct FilmMlpOutput {
  std::vector<float> density;  // [Q] >= 0, world^-1
  std::vector<float> rgb;      // [Q, 3] in (0, 1)
  std::vector<float> context;  // for backward
};

/// ∂L/∂(FilmMlpOutput) of a forward pass.
struct FilmMlpOutputGradients {
  const FilmMlpOutput& forward;
  const std::vector<float>& density;  // [Q]
  const std::vector<float>& rgb;      // [Q, 3]
};

struct FilmMlpGradients {
  std::vector<float> feature;    // [Q, inputs]
  std::vector<float> condition;  // [Q, condition]
};

// Interpolation of boundary features (ops/field/rbf.h). Eqs. (8)-(9)
/// The arguments shared by forward and backward. `graph` = nearest_points(boundary, query).
struct RbfProblem {
  Rows<const float, 3> query;     // [Q, 3] world
  Rows<const float, 3> boundary;  // [B, 3] world
  Matrix<const float> feature;    // [B, F]
  const KnnGraph* graph = nullptr;
  double width = 1;  // kernel width h > 0, world
};

struct RbfField {
  std::vector<float> weight;   // [Q, K] Σ_j = 1 per row
  std::vector<float> feature;  // [Q, F]
};

// Volume rendering (ops/field/volume.h). Eq. (1)
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
