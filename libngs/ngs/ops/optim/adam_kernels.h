#pragma once
// Scalar source of ops/optim/adam.h.
#include <cmath>
#include <cstdint>
#include <limits>

#include "ngs/core/hd.h"
#include "ngs/scene/views.h"

namespace ngs {

/// One Adam step (Kingma and Ba, eps outside the root as in PyTorch):
///
///   m ← β₁ m + (1-β₁) g      v ← β₂ v + (1-β₂) g²      x ← x - lr/(1-β₁ᵗ) · m / (√v / √(1-β₂ᵗ) + eps)
///
/// The host passes the t-dependent factors computed in double, so a large t costs no accuracy.
/// m and v move by a fraction of their distance to the target: the form βm + (1-β)g would round twice.
template <class T>
struct AdamKernel {
  static constexpr std::int64_t kChunk = 4096;  // elements per work item; only speed depends on it

  T* value;       // [n] x, updated
  const T* grad;  // [n] g, finite, g² representable
  T* m;           // [n] first moment, updated
  T* v;           // [n] second moment >= 0, updated
  std::int64_t n;
  T step;      // lr / (1-β₁ᵗ)
  T inv_root;  // 1 / √(1-β₂ᵗ)
  T one_minus_beta1, one_minus_beta2;
  T eps;

  NGS_HD void range(std::int64_t begin, std::int64_t end) const {
    using std::sqrt;
    for (std::int64_t i = begin; i < end; ++i) {
      const T g = grad[i];
      const T mi = m[i] + one_minus_beta1 * (g - m[i]);
      const T vi = v[i] + one_minus_beta2 * (g * g - v[i]);
      m[i] = mi;
      v[i] = vi;
      value[i] -= step * mi / (sqrt(vi) * inv_root + eps);
    }
  }
  NGS_HD void operator()(std::int64_t chunk) const {
    const std::int64_t begin = chunk * kChunk, end = begin + kChunk < n ? begin + kChunk : n;
    range(begin, end);
  }
};

/// Up to kMax blocks with the same step, as one range of elements.
struct AdamBlocks {
  static constexpr std::size_t kMax = 24;
  std::size_t count = 0;
  AdamKernel<float> block[kMax];
  std::int64_t sparse_columns[kMax];  // 0: dense
  std::int64_t begin[kMax + 1] = {0};

  void add(const AdamKernel<float>& kernel, std::int64_t columns) {
    block[count] = kernel;
    sparse_columns[count] = columns;
    begin[count + 1] = begin[count] + kernel.n;
    ++count;
  }
  NGS_HD std::int64_t size() const { return begin[count]; }
  NGS_HD std::size_t of(std::int64_t element) const {
    std::size_t b = 0;
    while (begin[b + 1] <= element) ++b;
    return b;
  }
};

/// 1 - βᵗ by expm1 of the logarithm: for β near 1 and small t, 1 minus the power would cancel.
NGS_HD inline double adam_bias(double beta, std::int64_t step) { return -std::expm1(double(step) * std::log(beta)); }

/// Gradients of larger magnitude have squares that are not representable.
template <class T>
T adam_limit() {
  return T(0.99) * std::sqrt(std::numeric_limits<T>::max());
}

/// The same for rows of `columns` values. Rows whose gradient is all zero are skipped: neither values
/// nor moments change.
template <class T>
struct SparseAdamKernel {
  AdamKernel<T> dense;
  std::int64_t columns;

  NGS_HD void operator()(std::int64_t row) const {
    const std::int64_t begin = row * columns, end = begin + columns;
    bool touched = false;
    for (std::int64_t i = begin; i < end; ++i) touched = touched || dense.grad[i] != T(0);
    if (touched) dense.range(begin, end);
  }
};

}  // namespace ngs
