#pragma once
// Scalar source of ops/losses/photometric.h: SSIM by separable moments and its adjoint, value by value. L: a lane type
// of math/lane_scalar.h or math/lanes.h.
//
// Images are [h, w, c] interleaved; a row is w·c values. Outside the image all values are zero, like the padding of
// conv2d in 3DGS.
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/lane_scalar.h"
#include "ngs/scene/views.h"

namespace ngs::ssim {

inline constexpr int kRadius = 5;                  // 11 x 11 window
inline constexpr double kSigma = 1.5;              // px
inline constexpr double kC1 = 1e-4, kC2 = 9e-4;    // (0.01)², (0.03)² for values in [0, 1]
enum Moment { kX, kY, kSquares, kXY, kMoments };   // of x, y, x² + y², xy
enum Partial { kDx, kDSquares, kDxy, kPartials };  // ∂S/∂(blurred x, x² + y², xy)

/// Taps from the middle outwards.
template <class T>
struct Window {
  T tap[kRadius + 1];
  Window() {
    double weight[kRadius + 1], sum = 0;
    for (int k = 0; k <= kRadius; ++k) {
      weight[k] = std::exp(-k * k / (2 * kSigma * kSigma));
      sum += k == 0 ? weight[k] : 2 * weight[k];
    }
    for (int k = 0; k <= kRadius; ++k) tap[k] = T(weight[k] / sum);
  }
};

/// Planes of values with `pad` zeros at both ends of every row, so that a tap along the row never tests a bound.
struct Layout {
  int w = 0, h = 0, c = 0;
  NGS_HD std::int64_t width() const { return std::int64_t(w) * c; }
  NGS_HD std::int64_t pad() const { return std::int64_t(kRadius) * c; }
  NGS_HD std::int64_t stride() const { return (width() + 7) / 8 * 8 + 2 * pad(); }  // whole packs
  NGS_HD std::int64_t plane() const { return stride() * h; }
  NGS_HD std::int64_t row(int y) const { return y * stride() + pad(); }  // index of column 0
};

/// A crop of a larger image: its first value and the row stride, in values.
template <class T>
struct Crop {
  T* first = nullptr;
  std::int64_t stride = 0;
  NGS_HD T* row(int y) const { return first + y * stride; }
};

/// Which pixels of the crop count, and how much.
struct PixelWeights {
  Crop<const float> weight;  // per pixel; null: 1
  int x0, x1, y0, y1;        // pixels outside only contribute to the windows of others
  NGS_HD float at(int px, int row) const {
    if (px < x0 || px >= x1 || row < y0 || row >= y1) return 0;
    return weight.first ? weight.row(row)[px] : 1.f;
  }
};

/// Inputs and output of a comparison, with the factors of |x - y| and of S in the loss.
template <class T>
struct Comparison {
  Layout layout;
  Crop<const T> x, y;
  PixelWeights weights;
  double ssim_factor, l1_factor;
  Crop<T> gradient;  // out; null: not wanted
};

/// One pass of the window: at(k) is the value k places from the middle.
template <class L, class T, class At>
NGS_HD L blurred(const Window<T>& window, const At& at) {
  L sum = L(window.tap[0]) * at(0);
  for (int k = 1; k <= kRadius; ++k) sum = fma_lanes(L(window.tap[k]), at(-k) + at(k), sum);
  return sum;
}

template <class L>
NGS_HD void products(L x, L y, L* out) {
  out[kX] = x;
  out[kY] = y;
  out[kSquares] = x * x + y * y;
  out[kXY] = x * y;
}

/// SSIM of one window from its blurred moments, and its partials.
///   S = (2 μx μy + C1)(2 σxy + C2) / ((μx² + μy² + C1)(σx² + σy² + C2)),  σx² + σy² = E[x² + y²] - μx² - μy²
/// In float σ² carries an absolute error of about eps·E[x²]; C2 keeps that below 1e-3 of the denominator for values in
/// [0, 1]. Rendered colours above 1 are not clamped: for them, σ² is clamped to >= 0, so that S keeps its sign.
template <class L>
NGS_HD L similarity(const L* moment, L* partial) {
  using T = typename LaneTraits<L>::Scalar;
  const L mx = moment[kX], my = moment[kY], two = L(T(2));
  const L means = mx * mx + my * my, product = mx * my;
  const L a1 = two * product + L(T(kC1)), b1 = means + L(T(kC1));
  const L a2 = two * (moment[kXY] - product) + L(T(kC2));
  const L b2 = max_lanes(moment[kSquares] - means, L(T(0))) + L(T(kC2));
  const L inv_b1 = L(T(1)) / b1, inv_b2 = L(T(1)) / b2, inv = inv_b1 * inv_b2;
  const L s = a1 * a2 * inv;
  partial[kDSquares] = -(s * inv_b2);
  partial[kDxy] = two * a1 * inv;
  partial[kDx] = two * ((a2 - a1) * my * inv + s * mx * (inv_b2 - inv_b1));
  return s;
}

template <class L>
NGS_HD L distance(L x, L y) {
  const L zero = L(typename LaneTraits<L>::Scalar(0)), d = x - y;
  return select(d < zero, -d, d);
}

/// ∂L/∂x = blur(dx) + 2x·blur(dsquares) + y·blur(dxy) + factor·sign(x - y); the window is symmetric, so the adjoint of
/// the blur is the blur. `blur`: the blurred partials, times the factor of S in the loss.
template <class L>
NGS_HD L gradient_of(const L* blur, L x, L y, L factor) {
  using T = typename LaneTraits<L>::Scalar;
  const L zero = L(T(0)), d = x - y;
  const L sign = select(d > zero, factor, select(d < zero, -factor, zero));
  return fma_lanes(L(T(2)) * x, blur[kDSquares], fma_lanes(y, blur[kDxy], blur[kDx])) + sign;
}

}  // namespace ngs::ssim
