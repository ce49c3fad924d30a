#include "ngs/edit/finish/clip_half_space.h"

#include <algorithm>
#include <cmath>

namespace ngs::finish {
namespace {

constexpr double kMinExtent = 1.0 / 64;  // of the extent across the plane that a clip leaves

using Vec = Vec3<double>;

Vec column(const Mat3<double>& axes, int a) { return {axes(0, a), axes(1, a), axes(2, a)}; }

/// The outline's point in front of the plane, relative to the centre, divided by side.outline: Σ n / sqrt(n'Σn).
Vec conjugate(const HalfSpace& side, const Ellipsoid& shape) {
  Vec sum{0, 0, 0};
  double variance = 0;
  for (int a = 0; a < 3; ++a) {
    const double along = shape.sigma[a] * dot(side.normal, column(shape.axes, a));
    sum = sum + (along * shape.sigma[a]) * column(shape.axes, a), variance += along * along;
  }
  return variance > 0 ? (1 / std::sqrt(variance)) * sum : Vec{0, 0, 0};
}

/// Jacobi's rotation of the symmetric `m` that makes entry (p, q) zero, collected in the columns of `axes`.
void rotate(int p, int q, Mat3<double>& m, Mat3<double>& axes) {
  if (m(p, q) == 0) return;
  const double theta = (m(q, q) - m(p, p)) / (2 * m(p, q));
  const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  Mat3<double> turn{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  turn(p, p) = turn(q, q) = c, turn(p, q) = s, turn(q, p) = -s;
  m = transpose(turn) * m * turn, axes = axes * turn;
  m(p, q) = m(q, p) = 0;
}

/// Scales the covariance by `shrink` along `direction`, which is conjugate to a plane: Σ - (1 - shrink²) d d'.
void shrink_along(Vec direction, double shrink, Ellipsoid& shape) {
  constexpr int kSweeps = 12;
  const double scale = *std::max_element(shape.sigma, shape.sigma + 3),
               least = shrink * *std::min_element(shape.sigma, shape.sigma + 3);
  const double d[3] = {direction.x / scale, direction.y / scale, direction.z / scale};
  Mat3<double> covariance{}, axes{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      for (int a = 0; a < 3; ++a) {
        const double size = shape.sigma[a] / scale;
        covariance(r, c) += size * size * shape.axes(r, a) * shape.axes(c, a);
      }
      covariance(r, c) -= (1 - shrink * shrink) * d[r] * d[c];
    }
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    rotate(0, 1, covariance, axes), rotate(0, 2, covariance, axes), rotate(1, 2, covariance, axes);
  shape.axes = axes;
  for (int a = 0; a < 3; ++a) shape.sigma[a] = std::max(scale * std::sqrt(std::max(covariance(a, a), 0.0)), least);
}

}  // namespace

Vec3<double> lowest_point(const HalfSpace& side, const Ellipsoid& shape) {
  return shape.centre - side.outline * conjugate(side, shape);
}

Clip clip_half_space(const HalfSpace& side, Ellipsoid& shape) {
  const Vec direction = conjugate(side, shape);
  const double height = dot(side.normal, shape.centre) - side.offset;
  const double reach = side.outline * dot(side.normal, direction);
  if (!std::isfinite(height) || !std::isfinite(reach) || !std::isfinite(dot(direction, direction)))
    return Clip::kWithin;
  if (height - reach >= 0) return Clip::kWithin;
  const double shrink = (height + reach) / (2 * reach);
  if (!(shrink > kMinExtent)) return Clip::kUnsupported;
  shape.centre = shape.centre + (side.outline * (1 - shrink)) * direction;
  shrink_along(direction, shrink, shape);
  return Clip::kClipped;
}

}  // namespace ngs::finish
