#pragma once
// Inputs, outputs and gradients of the FiLM network (ops/field/film_mlp.h).               Eqs. (12)-(15)
#include <vector>

#include "ngs/scene/views.h"

namespace ngs {

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

}  // namespace ngs
