#pragma once
// Scalar source of ops/photometric.h: SSIM by separable moments and its adjoint.
//
// Images are [h, w, c] interleaved; all kernels run over rows of the window W = w·c values. Moments live in planes
// with `pad` = kRadius·c zeros left and right of every row, so that a horizontal tap never tests a bound; a vertical
// tap outside the image is skipped, which is the zero padding of 3DGS's conv2d.
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/scene/views.h"

namespace ngs::ssim {

inline constexpr int kRadius = 5;        // 11 x 11 window
inline constexpr double kSigma = 1.5;    // px
inline constexpr double kC1 = 1e-4, kC2 = 9e-4;  // (0.01)², (0.03)² for values in [0, 1]
enum Moment { kX, kY, kXX, kYY, kXY, kMoments };
enum Partial { kDx, kDxx, kDxy, kPartials };

struct Window {
  double tap[2 * kRadius + 1];
  Window() {
    double sum = 0;
    for (int k = -kRadius; k <= kRadius; ++k) sum += tap[k + kRadius] = std::exp(-k * k / (2 * kSigma * kSigma));
    for (double& t : tap) t /= sum;
  }
};

struct Layout {
  int w = 0, h = 0, c = 0;
  NGS_HD std::int64_t width() const { return std::int64_t(w) * c; }
  NGS_HD std::int64_t pad() const { return std::int64_t(kRadius) * c; }
  NGS_HD std::int64_t stride() const { return width() + 2 * pad(); }
  NGS_HD std::int64_t plane() const { return stride() * h; }
  NGS_HD std::int64_t row(int y) const { return y * stride() + pad(); }  // index of column 0
};

/// The part of a larger image that is looked at: its first value and the distance of two rows, in values.
template <class T>
struct Crop {
  T* first = nullptr;
  std::int64_t stride = 0;
  NGS_HD T* row(int y) const { return first + y * stride; }
};

/// x, y, x², y², xy of one row into the padded planes.
template <class T>
struct Products {
  Layout layout;
  Crop<const T> x, y;
  T* planes;  // [kMoments, plane]

  NGS_HD void operator()(std::int64_t row) const {
    const T* a = x.row(int(row));
    const T* b = y.row(int(row));
    T* out = planes + layout.row(int(row));
    const std::int64_t n = layout.width(), plane = layout.plane();
    for (std::int64_t i = 0; i < n; ++i) store(out + i, plane, a[i], b[i]);
  }
  NGS_HD static void store(T* out, std::int64_t plane, T a, T b) {
    out[kX * plane] = a;
    out[kY * plane] = b;
    out[kXX * plane] = a * a;
    out[kYY * plane] = b * b;
    out[kXY * plane] = a * b;
  }
};

inline constexpr int kStrip = 64;  // values whose sums are kept at hand while the taps pass by; only speed depends on it

/// One row of a plane convolved along the row. Item = plane · h + row.
template <class T>
struct BlurRow {
  Layout layout;
  Window window;
  const T* in;
  T* out;

  /// Value i of the row alone: what the strips compute.
  NGS_HD void at(std::int64_t item, std::int64_t i) const {
    const std::int64_t index = (item / layout.h) * layout.plane() + layout.row(int(item % layout.h)) + i;
    T sum = T(window.tap[kRadius]) * in[index];
    for (int k = 1; k <= kRadius; ++k)
      sum += T(window.tap[kRadius + k]) * (in[index - k * layout.c] + in[index + k * layout.c]);
    out[index] = sum;
  }
  NGS_HD void operator()(std::int64_t item) const {
    const std::int64_t offset = (item / layout.h) * layout.plane() + layout.row(int(item % layout.h));
    for (std::int64_t begin = 0; begin < layout.width(); begin += kStrip) {
      const int count = layout.width() - begin < kStrip ? int(layout.width() - begin) : kStrip;
      const T* source = in + offset + begin;
      T sum[kStrip];
      for (int i = 0; i < count; ++i) sum[i] = T(window.tap[kRadius]) * source[i];
      for (int k = 1; k <= kRadius; ++k) {
        const T tap = T(window.tap[kRadius + k]);
        const T *left = source - k * layout.c, *right = source + k * layout.c;
        for (int i = 0; i < count; ++i) sum[i] += tap * (left[i] + right[i]);
      }
      for (int i = 0; i < count; ++i) out[offset + begin + i] = sum[i];
    }
  }
};

/// The same along columns.
template <class T>
struct BlurColumn {
  Layout layout;
  Window window;
  const T* in;
  T* out;

  /// Value i of the row alone: what the strips compute.
  NGS_HD void at(std::int64_t item, std::int64_t i) const {
    const int y = int(item % layout.h);
    const int first = y < kRadius ? -y : -kRadius, last = layout.h - 1 - y < kRadius ? layout.h - 1 - y : kRadius;
    const std::int64_t index = (item / layout.h) * layout.plane() + layout.row(y) + i;
    T sum = T(0);
    for (int k = first; k <= last; ++k) sum += T(window.tap[k + kRadius]) * in[index + k * layout.stride()];
    out[index] = sum;
  }
  NGS_HD void operator()(std::int64_t item) const {
    const int y = int(item % layout.h);
    const int first = y < kRadius ? -y : -kRadius, last = layout.h - 1 - y < kRadius ? layout.h - 1 - y : kRadius;
    const std::int64_t base = (item / layout.h) * layout.plane() + layout.row(y), n = layout.width();
    for (std::int64_t begin = 0; begin < n; begin += kStrip) {
      const int count = n - begin < kStrip ? int(n - begin) : kStrip;
      T sum[kStrip];
      for (int i = 0; i < count; ++i) sum[i] = T(0);
      for (int k = first; k <= last; ++k) {
        const T tap = T(window.tap[k + kRadius]);
        const T* source = in + base + k * layout.stride() + begin;
        for (int i = 0; i < count; ++i) sum[i] += tap * source[i];
      }
      for (int i = 0; i < count; ++i) out[base + begin + i] = sum[i];
    }
  }
};

/// SSIM of one window from its blurred moments, and ∂S/∂(blurred x, x², xy).
///   S = (2 μx μy + C1)(2 σxy + C2) / ((μx² + μy² + C1)(σx² + σy² + C2)),  σx² = E[x²] - μx²
/// In float σ² carries an absolute error of about eps·E[x²]; C2 keeps that below 1e-3 of the denominator.
template <class T>
NGS_HD T similarity(const T* moment, T* partial) {
  const T mx = moment[kX], my = moment[kY];
  const T a1 = T(2) * mx * my + T(kC1), b1 = mx * mx + my * my + T(kC1);
  const T a2 = T(2) * (moment[kXY] - mx * my) + T(kC2);
  const T b2 = (moment[kXX] - mx * mx) + (moment[kYY] - my * my) + T(kC2);
  const T inv = T(1) / (b1 * b2), s = a1 * a2 * inv;
  partial[kDxx] = -s / b2;
  partial[kDxy] = T(2) * a1 * inv;
  partial[kDx] = T(2) * ((a2 - a1) * my * inv - s * mx / b1 + s * mx / b2);
  return s;
}

/// Which pixels of the crop count, and how much.
struct PixelWeights {
  Crop<const float> weight;  // per pixel; null: 1
  int x0, x1, y0, y1;        // pixels outside only feed the windows of others
  NGS_HD double at(int px, int row) const {
    if (px < x0 || px >= x1 || row < y0 || row >= y1) return 0;
    return weight.first ? double(weight.row(row)[px]) : 1;
  }
};

/// Sums over one row; the partials are already times the factor of S in the loss. Acc: double, or Dual in tests.
/// Two passes: what is the same for every value vectorises, the ordered sums do not.
template <class T, class Acc>
struct RowLoss {
  Layout layout;
  const T* blurred;  // [kMoments, plane]
  T* planes;         // [kMoments, plane] out: partials, then S and |x - y|
  Crop<const T> x, y;
  PixelWeights weights;
  double ssim_factor;  // ∂L/∂S of a pixel of weight 1
  Acc* l1;             // [h] Σ w |x - y|
  Acc* ssim;           // [h] Σ w S

  NGS_HD void operator()(std::int64_t item) const {
    using std::abs;
    const int row = int(item);
    const std::int64_t plane = layout.plane(), base = layout.row(row), n = layout.width();
    const T* in = blurred + base;
    T* __restrict out = planes + base;
    const T *a = x.row(row), *b = y.row(row);
    for (std::int64_t i = 0; i < n; ++i) {
      const T moment[kMoments] = {in[i], in[plane + i], in[2 * plane + i], in[3 * plane + i], in[4 * plane + i]};
      T partial[kPartials];
      out[3 * plane + i] = similarity(moment, partial);
      out[4 * plane + i] = abs(a[i] - b[i]);
      out[i] = partial[kDx], out[plane + i] = partial[kDxx], out[2 * plane + i] = partial[kDxy];
    }
    Acc sum_l1 = Acc(0), sum_ssim = Acc(0);
    for (int px = 0; px < layout.w; ++px) {
      const double w = weights.at(px, row);
      const T factor = T(w * ssim_factor);
      for (std::int64_t i = std::int64_t(px) * layout.c; i < std::int64_t(px + 1) * layout.c; ++i) {
        sum_l1 += Acc(w) * Acc(out[4 * plane + i]);
        sum_ssim += Acc(w) * Acc(out[3 * plane + i]);
        for (int d = 0; d < kPartials; ++d) out[d * plane + i] *= factor;
      }
    }
    l1[row] = sum_l1;
    ssim[row] = sum_ssim;
  }
};

/// ∂L/∂x = blur(dx) + 2x·blur(dxx) + y·blur(dxy) + l1_factor·w·sign(x - y).        adjoint of RowLoss
template <class T>
struct RowGradient {
  Layout layout;
  const T* blurred;  // [kPartials, plane]; the window is symmetric, so the adjoint of the blur is the blur
  Crop<const T> x, y;
  PixelWeights weights;
  double l1_factor;
  Crop<T> gradient;  // out, overwritten

  NGS_HD void operator()(std::int64_t item) const {
    const int row = int(item);
    const std::int64_t plane = layout.plane(), base = layout.row(row);
    for (int px = 0; px < layout.w; ++px) {
      const T factor = T(weights.at(px, row) * l1_factor);
      for (int ch = 0; ch < layout.c; ++ch) {
        const std::int64_t i = std::int64_t(px) * layout.c + ch;
        gradient.row(row)[i] = value(blurred + base + i, plane, x.row(row)[i], y.row(row)[i], factor);
      }
    }
  }
  NGS_HD static T value(const T* at, std::int64_t plane, T a, T b, T factor) {
    const T difference = a - b;
    const T sign = difference > T(0) ? T(1) : (difference < T(0) ? T(-1) : T(0));
    return at[kDx * plane] + T(2) * a * at[kDxx * plane] + b * at[kDxy * plane] + factor * sign;
  }
};

}  // namespace ngs::ssim
