#include "ngs/ops/image_shift.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"

namespace ngs {
namespace {

constexpr int kMostSteps = 30, kBorder_px = 4;
constexpr double kSettled_px = 1e-3;
constexpr double kLeastTexture = 1e-14;  // determinant of the normal matrix, per squared weight: gradients below 3e-4 are noise

ImageF smoothed(const ImageF& in) {
  constexpr float kTap[5] = {1 / 16.f, 4 / 16.f, 6 / 16.f, 4 / 16.f, 1 / 16.f};
  ImageF rows(in.width_px, in.height_px, in.channels), out = rows;
  const auto pass = [&kTap](const ImageF& from, ImageF& to, int sx, int sy) {
    for (int y = 0; y < from.height_px; ++y)
      for (int x = 0; x < from.width_px; ++x)
        for (int c = 0; c < from.channels; ++c) {
          float sum = 0;
          for (int k = -2; k <= 2; ++k)
            sum += kTap[k + 2] * from.at(std::clamp(x + k * sx, 0, from.width_px - 1),
                                         std::clamp(y + k * sy, 0, from.height_px - 1), c);
          to.at(x, y, c) = sum;
        }
  };
  pass(in, rows, 1, 0), pass(rows, out, 0, 1);
  return out;
}

double bilinear(const ImageF& image, double x, double y, int c) {
  const int x0 = std::clamp(int(std::floor(x)), 0, image.width_px - 2),
            y0 = std::clamp(int(std::floor(y)), 0, image.height_px - 2);
  const double fx = std::clamp(x - x0, 0.0, 1.0), fy = std::clamp(y - y0, 0.0, 1.0);
  return (1 - fy) * ((1 - fx) * double(image.at(x0, y0, c)) + fx * double(image.at(x0 + 1, y0, c))) +
         fy * ((1 - fx) * double(image.at(x0, y0 + 1, c)) + fx * double(image.at(x0 + 1, y0 + 1, c)));
}

/// Weighted sums of one linearisation at a shift.
struct Normal {
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0, error = 0, weight = 0;
};

Normal linearise(const ImageF& moving, const ImageF& still, const ImageF& weight, double dx, double dy) {
  Normal n;
  for (int y = kBorder_px; y < still.height_px - kBorder_px; ++y)
    for (int x = kBorder_px; x < still.width_px - kBorder_px; ++x) {
      const double u = x - dx, v = y - dy, w = bilinear(weight, u, v, 0);
      for (int c = 0; c < still.channels; ++c) {
        const double gx = 0.5 * (bilinear(moving, u + 1, v, c) - bilinear(moving, u - 1, v, c)),
                     gy = 0.5 * (bilinear(moving, u, v + 1, c) - bilinear(moving, u, v - 1, c)),
                     r = double(still.at(x, y, c)) - bilinear(moving, u, v, c),
                     q = r * r / (kShiftResidual * kShiftResidual), cauchy = w / (1 + q);
        n.xx += cauchy * gx * gx, n.xy += cauchy * gx * gy, n.yy += cauchy * gy * gy;
        n.x -= cauchy * gx * r, n.y -= cauchy * gy * r;
        n.error += w * std::log1p(q), n.weight += w;
      }
    }
  return n;
}

}  // namespace

ImageShift find_shift(const ImageF& moving, const ImageF& still, const ImageF& weight) {
  NGS_CHECK(moving.width_px == still.width_px && moving.height_px == still.height_px &&
                moving.channels == still.channels && weight.width_px == still.width_px &&
                weight.channels == 1,
            "images of one size");
  ImageShift shift;
  if (still.width_px <= 2 * kBorder_px + 2 || still.height_px <= 2 * kBorder_px + 2) return shift;
  const ImageF from = smoothed(moving), to = smoothed(still);
  for (int step = 0; step < kMostSteps; ++step) {
    const Normal n = linearise(from, to, weight, shift.dx_px, shift.dy_px);
    const double mean = n.weight > 0 ? n.error / n.weight : 0;
    if (step == 0) shift.error_before = mean;
    shift.error_after = mean;
    if (shift.converged) return shift;
    const double det = n.xx * n.yy - n.xy * n.xy;
    if (!(det > kLeastTexture * n.weight * n.weight)) return shift;
    const double sx = (n.yy * n.x - n.xy * n.y) / det, sy = (n.xx * n.y - n.xy * n.x) / det;
    shift.dx_px += sx, shift.dy_px += sy;
    shift.converged = std::max(std::abs(sx), std::abs(sy)) < kSettled_px;
  }
  shift.converged = false;
  return shift;
}

}  // namespace ngs
