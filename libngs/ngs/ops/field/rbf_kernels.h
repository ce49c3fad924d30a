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
///   q         query position                        [3]     world
///   x         boundary positions                    [B, 3]  world
///   nearest   neighbour rows, nearest first         [K]     0 <= row[j] < B
///   inv_2h2   1 / (2 h²), h = kernel width          >= 0    world^-2
///   w         out: weights, Σ w_j = 1, w_0 largest  [K]
template <class T>
NGS_HD void rbf_weights(Vec3<T> q, Rows<const T, 3> x, NeighbourRows nearest, T inv_2h2, T* w) {
  using std::exp;
  const Vec3<T> x0 = vec3(x.row(nearest.row[0]));
  T sum = T(0);
  for (int j = 0; j < nearest.count; ++j) {
    const Vec3<T> xj = vec3(x.row(nearest.row[j]));
    w[j] = exp(-max2(dot(x0 - xj, (q - x0) + (q - xj)), T(0)) * inv_2h2);  // rounding may put x_j before x_0
    sum += w[j];
  }
  for (int j = 0; j < nearest.count; ++j) w[j] = w[j] / sum;  // sum >= w_0 = 1
}

/// f_i = Σ_j w_ij f_j.                                                                        Eq. (9)
/// Owns row i of `weight` and `out`.
template <class T>
struct RbfForward {
  static constexpr const char* kName = "rbf_forward";

  Rows<const T, 3> query;             // [Q, 3]  world
  Rows<const T, 3> boundary;          // [B, 3]  world
  Matrix<const std::uint32_t> index;  // [Q, K]  into boundary, nearest first
  Matrix<const T> feature;            // [B, F]
  T inv_2h2;                          //         world^-2
  Matrix<T> weight;                   // [Q, K]  out, kept for the backward pass
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
/// Gathers over the transposed neighbour graph, so row j has one writer and a fixed summation order.
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

/// ∂L/∂a_ij with a_ij = -d_ij² / 2h² the exponent: w_ij (s_ij - Σ_l w_il s_il), s_ij = Σ_f ∂L/∂f_i · f_j.
/// The first half of the position gradient (softmax backward). Owns row i.
template <class T>
struct RbfBackwardExponent {
  static constexpr const char* kName = "rbf_backward_exponent";

  Matrix<const std::uint32_t> index;  // [Q, K]
  Matrix<const T> feature;            // [B, F]
  Matrix<const T> weight;             // [Q, K]  from RbfForward
  Matrix<const T> grad_out;           // [Q, F]
  Matrix<T> grad_exponent;            // [Q, K]  out

  NGS_HD void operator()(std::int64_t i) const {
    const T* w = weight.row(i);
    T* g = grad_exponent.row(i);
    T mean = T(0);
    for (int j = 0; j < index.c; ++j) {
      T s = T(0);
      for (int f = 0; f < feature.c; ++f) s += grad_out.row(i)[f] * feature.row(index.row(i)[j])[f];
      g[j] = s;
      mean += w[j] * s;
    }
    for (int j = 0; j < index.c; ++j) g[j] = w[j] * (g[j] - mean);
  }
};

/// ∂L/∂x_j = Σ_{i : j ∈ N_i} ∂L/∂a_ij (q_i - x_j) / h².                            adjoint of Eq. (8)
/// The neighbour lists count as constant. Gathers; owns row j.
template <class T>
struct RbfBackwardPosition {
  static constexpr const char* kName = "rbf_backward_position";

  const std::int64_t* row_begin;  // [B + 1]
  const std::int64_t* edge;       // [Q·K]
  Matrix<const T> grad_exponent;  // [Q, K]  from RbfBackwardExponent
  Rows<const T, 3> query;         // [Q, 3]
  Rows<const T, 3> boundary;      // [B, 3]
  T inv_2h2;
  Rows<T, 3> grad_boundary;  // [B, 3]  out, overwritten

  NGS_HD void operator()(std::int64_t j) const {
    const Vec3<T> x = vec3(boundary.row(j));
    Vec3<T> sum{T(0), T(0), T(0)};
    for (std::int64_t e = row_begin[j]; e < row_begin[j + 1]; ++e)
      sum = sum + grad_exponent.data[edge[e]] * (vec3(query.row(edge[e] / grad_exponent.c)) - x);
    sum = (T(2) * inv_2h2) * sum;
    T* g = grad_boundary.row(j);
    g[0] = sum.x, g[1] = sum.y, g[2] = sum.z;
  }
};

/// ∂L/∂q_i = -Σ_j ∂L/∂a_ij (q_i - x_j) / h².                                       adjoint of Eq. (8)
/// The neighbour lists count as constant. Owns row i.
template <class T>
struct RbfBackwardQuery {
  static constexpr const char* kName = "rbf_backward_query";

  Matrix<const std::uint32_t> index;  // [Q, K]
  Matrix<const T> grad_exponent;      // [Q, K]  from RbfBackwardExponent
  Rows<const T, 3> query;             // [Q, 3]
  Rows<const T, 3> boundary;          // [B, 3]
  T inv_2h2;
  Rows<T, 3> grad_query;  // [Q, 3]  out, overwritten

  NGS_HD void operator()(std::int64_t i) const {
    const Vec3<T> q = vec3(query.row(i));
    Vec3<T> sum{T(0), T(0), T(0)};
    for (int j = 0; j < index.c; ++j) sum = sum + grad_exponent.row(i)[j] * (vec3(boundary.row(index.row(i)[j])) - q);
    sum = (T(2) * inv_2h2) * sum;
    T* g = grad_query.row(i);
    g[0] = sum.x, g[1] = sum.y, g[2] = sum.z;
  }
};

}  // namespace ngs
