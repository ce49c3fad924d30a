#include "ngs/orbit/free_space.h"

#include <algorithm>

#include "ngs/math/quat.h"

namespace ngs::orbit {
namespace {

constexpr int kMaxParts = 32;  // along an axis

/// A fraction of a Gaussian's extinction, at an offset from its centre in its own axes.
struct Part {
  Vec offset;
  double share;
};

/// Splits a Gaussian within 1.5 standard deviations into parts no wider than a cell. The shares sum to 1.
std::vector<Part> parts_of(const double (&deviation)[3], double cell) {
  int count[3];
  for (int k = 0; k < 3; ++k) count[k] = int(std::clamp(std::ceil(3 * deviation[k] / cell), 1.0, double(kMaxParts)));
  const auto at = [&](int axis, int k) { return count[axis] == 1 ? 0 : 3.0 * (k + 0.5) / count[axis] - 1.5; };
  std::vector<Part> parts;
  double total = 0;
  for (int k = 0; k < count[0] * count[1] * count[2]; ++k) {
    const Vec u{at(0, k % count[0]), at(1, k / count[0] % count[1]), at(2, k / count[0] / count[1])};
    parts.push_back({{deviation[0] * u.x, deviation[1] * u.y, deviation[2] * u.z}, std::exp(-0.5 * dot(u, u))});
    total += parts.back().share;
  }
  for (Part& part : parts) part.share /= total;
  return parts;
}

}  // namespace

FreeSpace::FreeSpace(const GaussianCloud& cloud, const SurfacePoints& points, const Frame& frame, Cube cube)
    : cube_(cube), size_(2 * cube.half / cube.cells) {
  const auto side = std::size_t(cube.cells);
  extinction_.assign(side * side * side, 0.f);
  const double volume = size_ * size_ * size_;
  for (std::size_t i = 0; i < points.count(); ++i) {
    const Vec p = frame.from_world(points.position[i]);
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > cube.half + 1.5 * points.size[i]) continue;
    const float* log_scale = &cloud.log_scale[3 * std::size_t(points.row[i])];
    const float* q = &cloud.rotation[4 * std::size_t(points.row[i])];
    const double s[3] = {std::exp(double(log_scale[0])), std::exp(double(log_scale[1])),
                         std::exp(double(log_scale[2]))};
    const double extinction =
        points.opacity[i] * 6.283185307179586 / 3 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]) / volume;
    const auto add = [&](Vec at, double share) {
      if (const std::int64_t cell = cell_at(at); cell >= 0) extinction_[std::size_t(cell)] += float(extinction * share);
    };
    if (3 * points.size[i] <= size_) {
      add(p, 1);
      continue;
    }
    const Mat3<double> turned = frame.axes * axes_of_quaternion(q);
    for (const Part& part : parts_of(s, size_)) add(p + turned * part.offset, part.share);
  }
}

std::int64_t FreeSpace::cell_at(Vec p) const {
  const double x = (p.x + cube_.half) / size_, y = (p.y + cube_.half) / size_, z = (p.z + cube_.half) / size_;
  const double n = cube_.cells;
  if (!(x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < n)) return -1;
  return (std::int64_t(z) * cube_.cells + std::int64_t(y)) * cube_.cells + std::int64_t(x);
}

double FreeSpace::depth_at(Vec p) const {
  const std::int64_t cell = cell_at(p);
  return cell < 0 ? 0 : size_ * double(extinction_[std::size_t(cell)]);
}

double FreeSpace::free_length(Vec from, Vec direction, Reach reach) const {
  const double step = 0.5 * size_,
               outside = cube_.half + size_;  // a cell beyond the cube, so that rounding is no matter
  double begin = 0, end = reach.most;
  for (const double Vec::*axis : {&Vec::x, &Vec::y, &Vec::z}) {
    const double a = (-outside - from.*axis) / direction.*axis, b = (outside - from.*axis) / direction.*axis;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  double depth = 0, at = 0.5 * step;
  while (at < std::min(begin, end)) at += step;  // nothing is there
  for (; at < end; at += step)
    if ((depth += 0.5 * depth_at(from + at * direction)) >= reach.limit) return at - 0.5 * step;
  return reach.most;
}

}  // namespace ngs::orbit
