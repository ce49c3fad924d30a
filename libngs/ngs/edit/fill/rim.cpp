#include "ngs/edit/fill/rim.h"

#include <algorithm>
#include <cmath>

#include "ngs/math/median.h"
#include "ngs/math/stable.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr double kStray = 0.005;       // share of the Gaussians trimmed at each side of the box, before the margin
constexpr double kStrayMargin = 0.1;   // diagonals
constexpr double kSurroundings = 0.6;  // diagonals: width of the band that supplies textures
constexpr double kRimReach = 0.25;     // diagonals: width of the band in which surfaces are searched
constexpr double kSolidOpacity = 0.5;
constexpr double kNeedle = 4;  // longest to second standard deviation
constexpr std::size_t kMaxSpacings = 4000;

/// The range of the values without the strays at both ends.
std::pair<double, double> bulk_range(std::vector<double> values) {
  const auto at = [&](double share) {
    const auto k = std::ptrdiff_t(std::llround(share * double(values.size() - 1)));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[std::size_t(k)];
  };
  const double low = at(kStray);
  return {low, at(1 - kStray)};
}

Box bulk_box(const GaussianCloud& cloud, const std::vector<std::uint32_t>& rows) {
  std::array<std::pair<double, double>, 3> side;
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> values;
    for (const std::uint32_t row : rows) values.push_back(cloud.position[3 * row + a]);
    side[a] = bulk_range(std::move(values));
  }
  return {{side[0].first, side[1].first, side[2].first}, {side[0].second, side[1].second, side[2].second}};
}

Vec position_of(const GaussianCloud& cloud, std::size_t row) {
  return {cloud.position[3 * row], cloud.position[3 * row + 1], cloud.position[3 * row + 2]};
}

bool is_rendered(const GaussianCloud& cloud, std::size_t row) {
  return cloud.usable[row] && sigmoid(double(cloud.logit_opacity[row])) > 1.0 / 255;
}

void add_point(const GaussianCloud& cloud, std::uint32_t row, orbit::SurfacePoints& points) {
  const std::array<double, 3> size = sorted_sizes(cloud, row);
  const double opacity = sigmoid(double(cloud.logit_opacity[row]));
  points.row.push_back(row);
  points.position.push_back(position_of(cloud, row));
  points.opacity.push_back(opacity);
  points.size.push_back(size[2]);
  points.area.push_back(opacity * 3.14159265358979 * size[1] * size[2]);
}

bool is_solid(const GaussianCloud& cloud, const orbit::SurfacePoints& points, std::size_t i) {
  const std::array<double, 3> size = sorted_sizes(cloud, points.row[i]);
  return points.opacity[i] > kSolidOpacity && size[2] <= kNeedle * size[1];
}

}  // namespace

std::array<double, 3> sorted_sizes(const GaussianCloud& cloud, std::size_t row) {
  std::array<double, 3> size;
  for (std::size_t a = 0; a < 3; ++a) size[a] = std::exp(double(cloud.log_scale[3 * row + a]));
  std::sort(size.begin(), size.end());
  return size;
}

double surface_spacing(const Exec& exec, const std::vector<Vec>& points) {
  constexpr int kNeighbour = 4;
  constexpr double kGridPerNeighbour = 0.886;  // sqrt(pi / 4): expected distances in a plane of even density
  if (points.size() < 2) return 0;
  std::vector<float> all, some;
  for (const Vec& p : points)
    for (const double x : {p.x - points[0].x, p.y - points[0].y, p.z - points[0].z}) all.push_back(float(x));
  for (const std::size_t i : orbit::thinned(points.size(), kMaxSpacings))
    some.insert(some.end(), all.begin() + std::ptrdiff_t(3 * i), all.begin() + std::ptrdiff_t(3 * i + 3));
  const KnnGraph graph =
      nearest_points(exec, {all.data(), std::int64_t(points.size())}, {some.data(), std::int64_t(some.size() / 3)},
                     kNeighbour + 1);  // with the point itself
  std::vector<double> distance;
  for (std::int64_t q = 0; q < graph.queries(); ++q)
    distance.push_back(std::sqrt(double(graph.dist2[std::size_t((q + 1) * graph.neighbours - 1)])));
  return kGridPerNeighbour * upper_median(std::move(distance)) * std::sqrt(double(kNeighbour) / (graph.neighbours - 1));
}

Rim find_rim(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& object) {
  Rim rim;
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < object.size(); ++i)
    if (object[i] && is_rendered(cloud, i)) rows.push_back(std::uint32_t(i));
  if (rows.empty()) return rim;
  Box box = bulk_box(cloud, rows);
  const double stray = kStrayMargin * box.diagonal();
  Box all{box.high, box.low};
  for (const std::uint32_t row : rows) {
    const Vec p = position_of(cloud, row);
    if (!box.contains(p, stray)) continue;
    add_point(cloud, row, rim.object);
    all.low = {std::min(all.low.x, p.x), std::min(all.low.y, p.y), std::min(all.low.z, p.z)};
    all.high = {std::max(all.high.x, p.x), std::max(all.high.y, p.y), std::max(all.high.z, p.z)};
  }
  rim.box = all;
  rim.diagonal = all.diagonal();
  std::vector<Vec> solid;
  for (std::size_t i = 0; i < object.size(); ++i) {
    const Vec p = position_of(cloud, i);
    if (object[i] || !all.contains(p, kSurroundings * rim.diagonal) || !is_rendered(cloud, i)) continue;
    add_point(cloud, std::uint32_t(i), rim.background);
    const std::size_t k = rim.background.count() - 1;
    if (!all.contains(p, kRimReach * rim.diagonal) || !is_solid(cloud, rim.background, k)) continue;
    rim.solid.push_back(std::uint32_t(k));
    solid.push_back(rim.background.position[k]);
  }
  rim.spacing = surface_spacing(exec, solid);
  return rim;
}

}  // namespace ngs
