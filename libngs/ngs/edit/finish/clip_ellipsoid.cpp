#include "ngs/edit/finish/clip_ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace ngs::finish {
namespace {

constexpr int kMinScanSteps = 16, kMaxScanSteps = 64;  // of the scan along an axis
constexpr int kBisections = 5;                         // of a step
constexpr double kMinShare = 1.0 / 64;                 // of a standard deviation that a clip leaves
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

}  // namespace

Clip clip_ellipsoid(double least, const Supported& supported, Ellipsoid& shape, double outline) {
  return Clipper(least, supported, shape, outline).run();
}

}  // namespace ngs::finish
