#pragma once
// Inputs and outputs of the interpolation of boundary features (ops/field/rbf.h).         Eqs. (8)-(9)
#include <vector>

#include "ngs/scene/knn_graph.h"

namespace ngs {

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

}  // namespace ngs
