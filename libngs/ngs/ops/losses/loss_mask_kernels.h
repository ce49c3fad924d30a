#pragma once
// The mask loss at one pixel and the density weights.                              Eq. (19); C18, C19
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/pixel_grid.h"
#include "ngs/math/stable.h"

namespace ngs {

/// Predictions closer than this to 0 or 1 do not enter the logarithm. Composited masks reach neither 0 nor 1.
inline constexpr double kMaskEps = 1e-6;

/// A loss and its derivative.
template <class T>
struct LossSlope {
  T value, slope;
};

/// -m ln p - (1 - m) ln(1 - p). Beyond [eps, 1 - eps] the loss continues along its tangent: a clamp would leave a
/// saturated wrong pixel without a gradient. log1p: the loss of an almost correct background pixel is about p, and 1 -
/// p would lose the low digits of p.
template <class T>
NGS_HD LossSlope<T> mask_bce(T p, T m) {
  const T low = T(kMaskEps), at = clamp3(p, low, T(1) - low), rest = T(1) - at;
  const T slope = (T(1) - m) / rest - m / at;
  const T hit = m > T(0) ? -m * log_of(at) : T(0),
          miss = m < T(1) ? (T(1) - m) * log1p_of(-at) : T(0);  // most masks are 0 or 1
  return {hit - miss + slope * (p - at), slope};
}

/// -m p + λ (1 - m) p: the linear loss of COB-GS (λ = 1) and SA3D-GS (λ = 0.3).
template <class T>
NGS_HD LossSlope<T> mask_linear(T p, T m, T lambda) {
  const T slope = lambda * (T(1) - m) - m;
  return {slope * p, slope};
}

/// One image row: its share of the loss and the gradient of its pixels. Owns row y. Acc sums the row.
template <class T, class Acc>
struct MaskLossRow {
  static constexpr const char* kName = "mask_loss_row";
  int width, objects;
  const T* rendered;           // [H, W, K]
  const float* const* target;  // [K][H, W]
  const std::uint8_t* known;   // [H, W]; null: all known
  const float* pixel_weight;   // [H, W]; null: 1
  bool linear;
  T lambda;
  T scale;           // of the gradient: ∂(total)/∂(sum)
  Acc* row_sum;      // [H]       out
  T* grad_rendered;  // [H, W, K] out, overwritten; null: not wanted

  NGS_HD void operator()(std::int64_t y) const {
    Acc sum(0);
    for (int x = 0; x < width; ++x) pixel(y * width + x, sum);
    row_sum[y] = sum;
  }
  /// Adds pixel p to `sum` and writes its gradient.
  NGS_HD void pixel(std::int64_t p, Acc& sum) const {
    const bool counts = known == nullptr || known[p] != 0;
    const T weight = T(counts ? (pixel_weight ? pixel_weight[p] : 1.f) : 0.f);
    for (int k = 0; k < objects; ++k) {
      const T prediction = rendered[p * objects + k], m = T(target[k][p]);
      LossSlope<T> loss{T(0), T(0)};
      if (counts) loss = linear ? mask_linear(prediction, m, lambda) : mask_bce(prediction, m);
      sum += Acc(weight * loss.value);
      if (grad_rendered) grad_rendered[p * objects + k] = scale * weight * loss.slope;
    }
  }
};

/// sigmoid(D) at a pixel, D interpolated between the nodes of the grid (held constant from the outer nodes to
/// the box); 0.5 outside the box, where the field is not sampled. Owns pixel i.
struct DensityWeight {
  static constexpr const char* kName = "density_weight";
  PixelGrid grid;
  double min_x, min_y, max_x, max_y;  // box, px
  int width;
  const float* optical_depth;  // [R] >= 0
  float* weight;               // [H, W] out

  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t column = i % width, line = i / width;
    const double x = double(column) + 0.5, y = double(line) + 0.5;
    if (grid.cols == 0 || x < min_x || x > max_x || y < min_y || y > max_y) {
      weight[i] = 0.5f;
      return;
    }
    const BilinearAxis u = bilinear_axis((x - grid.first_x) / grid.step_x + 0.5, grid.cols);
    const BilinearAxis v = bilinear_axis((y - grid.first_y) / grid.step_y + 0.5, grid.rows);
    const auto row = [&](int r) {
      const float* d = optical_depth + static_cast<std::int64_t>(r) * grid.cols;
      return (1 - u.weight) * finite(d[u.lower]) + u.weight * finite(d[u.upper]);
    };
    weight[i] = sigmoid(float((1 - v.weight) * row(v.lower) + v.weight * row(v.upper)));
  }

 private:
  /// Optical depths may overflow to infinity; a weight of 0 times infinity would be NaN.
  NGS_HD static double finite(float depth) { return min2(double(depth), 0x1.fffffep127); }
};

}  // namespace ngs
