#include "ngs/edit/finish/clip_ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace ngs::finish {
namespace {

constexpr int kMinScanSteps = 16, kMaxScanSteps = 64;  // of the scan along an axis
constexpr int kBisections = 5;                         // of a step
constexpr double kMinShare = 1.0 / 64;                 // minimum share of a standard deviation after a clip
constexpr double kDiagonal = 0.70710678118654752;

using Vec = Vec3<double>;

class Clipper {
 public:
  Clipper(double least, const Supported& supported, Ellipsoid& shape, double outline)
      : least_(least), outline_(outline), supported_(supported), shape_(shape) {
    for (int a = 0; a < 3; ++a)
      if (outline_ * shape_.sigma[a] > least_) long_.push_back(a);
    std::ranges::stable_sort(long_, [&](int a, int b) { return shape_.sigma[a] > shape_.sigma[b]; });
  }

  Clip run() {
    if (long_.empty()) return supported_(shape_.centre) ? Clip::kWithin : Clip::kUnsupported;
    if (is_within()) return Clip::kWithin;
    const Ellipsoid before = shape_;
    bool any = false;
    for (const int a : long_) any |= clip_axis(a);
    if (!any) return shape_ = before, Clip::kUnsupported;
    clip_diagonals();
    const bool same = std::ranges::equal(shape_.sigma, before.sigma);
    return same ? Clip::kWithin : Clip::kClipped;
  }

 private:
  /// The point at these multiples of the standard deviations along two axes.
  Vec at(int a, double t, int b = 0, double u = 0) const {
    const double along = t * shape_.sigma[a], across = u * shape_.sigma[b];
    return shape_.centre + along * column(a) + across * column(b);
  }
  Vec column(int a) const { return {shape_.axes(0, a), shape_.axes(1, a), shape_.axes(2, a)}; }

  bool is_within() const {
    if (!supported_(shape_.centre)) return false;
    for (const int a : long_)
      for (const double t : {-outline_, outline_, -0.5 * outline_, 0.5 * outline_})
        if (!supported_(at(a, t))) return false;
    return has_diagonals(1);
  }

  /// The last supported place on the way from t, which is supported, to `end`, which is not.
  double edge(int a, double t, double end) const {
    for (int k = 0; k < kBisections; ++k) {
      const double middle = 0.5 * (t + end);
      (supported_(at(a, middle)) ? t : end) = middle;
    }
    return t;
  }

  /// Clips along axis `a`. False: no point on it is supported.
  bool clip_axis(int a) {
    const double length = 2 * outline_ * shape_.sigma[a];
    const double wanted = least_ > 0 ? std::ceil(2 * length / least_) : kMinScanSteps;
    const int steps = int(std::clamp(wanted, double(kMinScanSteps), double(kMaxScanSteps)));
    const auto place = [&](int k) { return outline_ * (2.0 * k / steps - 1); };
    std::vector<std::uint8_t> is_in;
    for (int k = 0; k <= steps; ++k) is_in.push_back(supported_(at(a, place(k))));
    const auto distance = [&](int k) { return std::abs(2 * k - steps); };
    int nearest = -1;
    for (int k = 0; k <= steps; ++k)
      if (is_in[std::size_t(k)] && (nearest < 0 || distance(k) < distance(nearest))) nearest = k;
    if (nearest < 0) return false;
    int first = nearest, last = nearest;
    while (first > 0 && is_in[std::size_t(first - 1)]) --first;
    while (last < steps && is_in[std::size_t(last + 1)]) ++last;
    const double lo = first > 0 ? edge(a, place(first), place(first - 1)) : -outline_;
    const double hi = last < steps ? edge(a, place(last), place(last + 1)) : outline_;
    fit_axis(a, lo, hi);
    return true;
  }

  void fit_axis(int a, double lo, double hi) {
    const double shrink = std::max((hi - lo) / (2 * outline_), kMinShare);
    if (!(shrink < 1)) return;
    shape_.centre = at(a, 0.5 * (lo + hi));
    shape_.sigma[a] *= shrink;
  }

  /// Whether the four diagonals between the two longest axes are supported at `share` of the outline.
  bool has_diagonals(double share) const {
    if (long_.size() < 2) return true;
    const double r = kDiagonal * outline_ * share;
    for (const double t : {-r, r})
      for (const double u : {-r, r})
        if (!supported_(at(long_[0], t, long_[1], u))) return false;
    return true;
  }

  /// Shrinks the two longest axes until their diagonals are supported, to a quarter at most.
  void clip_diagonals() {
    if (long_.size() < 2) return;
    double share = 1;
    while (share > 0.25 && !has_diagonals(share)) share -= 0.25;
    for (const int a : {long_[0], long_[1]}) shape_.sigma[a] *= share;
  }

  double least_, outline_;
  const Supported& supported_;
  Ellipsoid& shape_;
  std::vector<int> long_;  // tested axes, from the longest
};

constexpr double kMinExtent = 1.0 / 64;  // minimum share of the extent across the plane after a clip

Vec column(const Mat3<double>& axes, int a) { return {axes(0, a), axes(1, a), axes(2, a)}; }

/// Offset of the outline point farthest in front of the plane, divided by side.outline: Σ n / sqrt(n'Σn).
Vec conjugate(const HalfSpace& side, const Ellipsoid& shape) {
  Vec sum{0, 0, 0};
  double variance = 0;
  for (int a = 0; a < 3; ++a) {
    const double along = shape.sigma[a] * dot(side.normal, column(shape.axes, a));
    sum = sum + (along * shape.sigma[a]) * column(shape.axes, a);
    variance += along * along;
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
  turn(p, p) = turn(q, q) = c;
  turn(p, q) = s;
  turn(q, p) = -s;
  m = transpose(turn) * m * turn;
  axes = axes * turn;
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
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    rotate(0, 1, covariance, axes);
    rotate(0, 2, covariance, axes);
    rotate(1, 2, covariance, axes);
  }
  shape.axes = axes;
  for (int a = 0; a < 3; ++a) shape.sigma[a] = std::max(scale * std::sqrt(std::max(covariance(a, a), 0.0)), least);
}

}  // namespace

Clip clip_ellipsoid(double least, const Supported& supported, Ellipsoid& shape, double outline) {
  return Clipper(least, supported, shape, outline).run();
}

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
