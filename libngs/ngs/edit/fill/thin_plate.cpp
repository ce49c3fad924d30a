#include "ngs/edit/fill/thin_plate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ngs {
namespace {

double squared_distance(Vec2<double> a, Vec2<double> b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

double bending(Vec2<double> a, Vec2<double> b) {
  const double r2 = squared_distance(a, b);
  return r2 > 0 ? 0.5 * r2 * std::log(r2) : 0;  // r² ln r
}

/// Solves the row-major n x (n + 1) system by elimination with partial pivoting. False if it is singular.
bool solve(std::vector<double>& m, std::size_t n) {
  constexpr double kSingular = 1e-10;  // pivots are of order 1: coordinates are scaled to the unit disc
  const std::size_t columns = n + 1;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t r = k + 1; r < n; ++r)
      if (std::abs(m[r * columns + k]) > std::abs(m[pivot * columns + k])) pivot = r;
    if (!(std::abs(m[pivot * columns + k]) > kSingular)) return false;
    if (pivot != k)
      std::swap_ranges(m.begin() + std::ptrdiff_t(k * columns), m.begin() + std::ptrdiff_t((k + 1) * columns),
                       m.begin() + std::ptrdiff_t(pivot * columns));
    for (std::size_t r = k + 1; r < n; ++r) {
      const double factor = m[r * columns + k] / m[k * columns + k];
      if (factor == 0) continue;
      for (std::size_t c = k; c < columns; ++c) m[r * columns + c] -= factor * m[k * columns + c];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    double sum = m[k * columns + n];
    for (std::size_t c = k + 1; c < n; ++c) sum -= m[k * columns + c] * m[c * columns + n];
    m[k * columns + n] = sum / m[k * columns + k];
  }
  return true;
}

}  // namespace

ThinPlate::ThinPlate(const std::vector<Vec2<double>>& points, const std::vector<double>& heights, double smoothing) {
  const std::size_t count = points.size(), n = count + 3, columns = n + 1;
  if (count < 3) return;
  for (const Vec2<double>& p : points) {
    middle_.x += p.x / double(count);
    middle_.y += p.y / double(count);
  }
  double radius = 0;
  for (const Vec2<double>& p : points) radius = std::max(radius, std::sqrt(squared_distance(p, middle_)));
  if (!(radius > 0)) return;
  scale_ = radius;
  for (const Vec2<double>& p : points) centre_.push_back({(p.x - middle_.x) / scale_, (p.y - middle_.y) / scale_});
  std::vector<double> m(n * columns);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) m[i * columns + j] = bending(centre_[i], centre_[j]);
    m[i * columns + i] += smoothing;
    const double plane[3] = {1, centre_[i].x, centre_[i].y};
    for (std::size_t k = 0; k < 3; ++k) m[i * columns + count + k] = m[(count + k) * columns + i] = plane[k];
    m[i * columns + n] = heights[i];
  }
  if (!solve(m, n)) {
    centre_.clear();
    return;
  }
  for (std::size_t k = 0; k < n; ++k) weight_.push_back(m[k * columns + n]);
}

double ThinPlate::at(double u, double v) const {
  if (centre_.empty()) return 0;
  const Vec2<double> p{(u - middle_.x) / scale_, (v - middle_.y) / scale_};
  const std::size_t count = centre_.size();
  double sum = weight_[count] + weight_[count + 1] * p.x + weight_[count + 2] * p.y;
  for (std::size_t j = 0; j < count; ++j) sum += weight_[j] * bending(p, centre_[j]);
  return sum;
}

}  // namespace ngs
