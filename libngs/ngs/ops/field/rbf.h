#pragma once
// Interpolation of boundary features at query points.                                     Eqs. (8)-(9)
//
// The weights are the L1-normalised Gaussians of Eq. (8), computed as a softmax of -d²/2h². This equals the printed
// form where that is defined, and tends to the nearest neighbour where the printed form is 0/0 (C22). With an empty
// graph (no boundary Gaussians) every feature is 0. Results do not depend on exec.threads.
#include "ngs/backend/exec.h"
#include "ngs/ops/field/field_types.h"

namespace ngs {

/// 1 / (2 h²), limited to the largest float: the nearest neighbour's exponent is 0 times it.
float inv_2h2(double width);

void rbf_forward(const Exec& exec, const RbfProblem& problem, RbfField& out);

/// Overwrites `out` with ∂L/∂feature [B, F] of `grad_feature` = ∂L/∂(field.feature) [Q, F]. The weights are treated as
/// constant (C25).
void rbf_backward(const Exec& exec, const RbfProblem& problem, const RbfField& field, Matrix<const float> grad_feature,
                  std::vector<float>& out);

/// The kernel width: factor · mean spacing of the boundary Gaussians (C22). 1 if the spacing is 0 (one Gaussian, or all
/// coincident): every width then gives the same weights.
double auto_rbf_width(const Exec& exec, Rows<const float, 3> boundary, int neighbours, double factor);

}  // namespace ngs
