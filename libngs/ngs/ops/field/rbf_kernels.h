#pragma once
// Scalar maths of RBF interpolation.                                                      Eqs. (8)-(9)
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/stable.h"
#include "ngs/math/vec.h"
#include "ngs/scene/views.h"

namespace ngs {

/// The neighbours of one query point, nearest first.
struct NeighbourRows {
  const std::uint32_t* row;
  int count;
};

/// Normalised Gaussian weights of one query point.                              Eq. (8), L1-normalised
///
///   w_j = exp(-(d_j² - d_0²) / 2h²) / Σ_l exp(-(d_l² - d_0²) / 2h²),   d_j = ‖q - x_j‖
///
/// Eq. (8) as printed is 0/0 once every d_j > ~14 h (float exp underflows). Subtracting the nearest d_0²
/// cancels in the ratio, and the factored form d_j² - d_0² = (x_0 - x_j)·((q - x_0) + (q - x_j)) leaves an
/// error of order eps·‖x_0 - x_j‖·d / h² in the exponent instead of eps·d² / h².
///
// clang-format off
///   q         query position                        [3]     world
///   x         boundary positions                    [B, 3]  world
///   nearest   neighbour rows, nearest first         [K]     0 <= row[j] < B
///   inv_2h2   1 / (2 h²), h = kernel width          >= 0    world^-2
///   w         out: weights, Σ w_j = 1, w_0 largest  [K]
// clang-format on
template <class T>
NGS_HD void rbf_weights(Vec3<T> q, Rows<const T, 3> x, NeighbourRows nearest, T inv_2h2, T* w) {
  const Vec3<T> x0 = vec3(x.row(nearest.row[0]));
  T sum = T(0);
  for (int j = 0; j < nearest.count; ++j) {
    const Vec3<T> xj = vec3(x.row(nearest.row[j]));
    w[j] = exp_of(-max2(dot(x0 - xj, (q - x0) + (q - xj)), T(0)) * inv_2h2);  // rounding may put x_j before x_0
    sum += w[j];
  }
  for (int j = 0; j < nearest.count; ++j) w[j] = w[j] / sum;  // sum >= w_0 = 1
}

/// f_i = Σ_j w_ij f_j.                                                                        Eq. (9)
/// Index i writes row i of `weight` and `out`.
template <class T>
struct RbfForward {
  static constexpr const char* kName = "rbf_forward";

  Rows<const T, 3> query;             // [Q, 3]  world
  Rows<const T, 3> boundary;          // [B, 3]  world
  Matrix<const std::uint32_t> index;  // [Q, K]  into boundary, nearest first
  Matrix<const T> feature;            // [B, F]
  T inv_2h2;                          //         world^-2
  Matrix<T> weight;                   // [Q, K]  out, input of the backward pass
  Matrix<T> out;                      // [Q, F]  out

  NGS_HD void operator()(std::int64_t i) const {
    T* w = weight.row(i);
    rbf_weights(vec3(query.row(i)), boundary, {index.row(i), index.c}, inv_2h2, w);
    for (int f = 0; f < feature.c; ++f) {
      T sum = T(0);
      for (int j = 0; j < index.c; ++j) sum += w[j] * feature.row(index.row(i)[j])[f];
      out.row(i)[f] = sum;
    }
  }
};

/// ∂L/∂f_j = Σ_{i : j ∈ N_i} w_ij ∂L/∂f_i.                                         adjoint of Eq. (9)
/// Gathers over the transposed neighbour graph: row j has one writer and a fixed order of summation.
template <class T>
struct RbfBackwardFeature {
  static constexpr const char* kName = "rbf_backward_feature";

  const std::int64_t* row_begin;  // [B + 1]  rows of the transposed graph
  const std::int64_t* edge;       // [Q·K]    flat index i·K + slot into `weight`, ascending per row
  Matrix<const T> weight;         // [Q, K]   from RbfForward
  Matrix<const T> grad_out;       // [Q, F]   ∂L/∂out
  Matrix<T> grad_feature;         // [B, F]   out, overwritten

  NGS_HD void operator()(std::int64_t j) const {
    for (int f = 0; f < grad_feature.c; ++f) grad_feature.row(j)[f] = T(0);
    for (std::int64_t e = row_begin[j]; e < row_begin[j + 1]; ++e) {
      const T w = weight.data[edge[e]];
      const T* g = grad_out.row(edge[e] / weight.c);
      for (int f = 0; f < grad_feature.c; ++f) grad_feature.row(j)[f] += w * g[f];
    }
  }
};

}  // namespace ngs
