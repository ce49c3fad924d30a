#pragma once
// L_cont: neighbouring boundary Gaussians have similar colours.                            Eq. (17)
//
//   L = 1/|B| Σ_i Σ_{j ∈ N_i} ω_ij ‖C_i - C_j‖²,   ω = 1/|N_i|, or the given weights (rows that sum to 1)
//
// C is the colour of the constant SH band, rgb = 0.5 + 0.2820948 · sh_dc. The graph (nearest_others) and the weights
// are constants. An empty graph: loss 0. Results do not depend on exec.threads.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/ops/optim/row_kernels.h"
#include "ngs/scene/knn_graph.h"

namespace ngs {

struct ContinuityInputs {
  const KnnGraph& graph;
  Rows<const float, 3> colour;     // [B, 3]
  std::vector<float> weight = {};  // [B, K] or empty
};

/// `gradient`: null, or scale · ∂L/∂colour [B, 3], overwritten. `add`: null, or the rows to which the gradient is
/// added; its `grad_colour` is set here, and on a device its arrays are resident.
double loss_cont(const Exec& exec, const ContinuityInputs& in, double scale, std::vector<float>* gradient,
                 const AddRowColourGradients* add = nullptr);

}  // namespace ngs
