#include "ngs/edit/fill/debris.h"

#include <algorithm>

#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr int kNeighbours = 8;
// Minimum share of the neighbours that belong to the object.
constexpr double kMinObjectShareSolid = 0.75, kMinObjectShareTranslucent = 0.5;
constexpr double kSolid = 0.5;                       // opacity
constexpr double kLong = 4;                          // longest to second standard deviation of a needle
constexpr double kMaxSize = 0.08, kMaxFaint = 0.25;  // diagonals: larger ones are part of the surroundings

void append_point(std::vector<float>& to, Vec p) {
  for (const double x : {p.x, p.y, p.z}) to.push_back(float(x));
}

bool is_on_surface(const std::vector<FillSurface>& surfaces, Vec p) {
  return std::ranges::any_of(surfaces, [&](const FillSurface& s) { return s.height(p) <= s.tolerance; });
}

}  // namespace

std::vector<std::uint8_t> find_debris(const Exec& exec, const GaussianCloud& cloud, const Rim& rim,
                                      const Occluder& occluder, const std::vector<FillSurface>& surfaces) {
  const orbit::SurfacePoints& points = rim.background;
  std::vector<std::uint8_t> debris(points.count());
  std::vector<float> around, queries;
  std::vector<std::size_t> tested;
  std::int64_t of_object = 0;
  for (std::size_t i = 0; i < rim.object.count(); ++i)
    if (rim.object.opacity[i] > kSolid) {
      append_point(around, rim.object.position[i]);
      ++of_object;
    }
  for (const std::uint32_t k : rim.solid) append_point(around, points.position[k]);
  const double margin = 0.05 * rim.diagonal;
  for (std::size_t i = 0; i < points.count(); ++i) {
    const Vec p = points.position[i];
    const double most = rim.diagonal * (points.opacity[i] <= kSolid ? kMaxFaint : kMaxSize);
    if (!rim.box.contains(p, margin) || points.size[i] > most || is_on_surface(surfaces, p)) continue;
    tested.push_back(i);
    append_point(queries, p);
  }
  if (tested.empty() || around.size() < 3 * std::size_t(kNeighbours + 1)) return debris;
  const KnnGraph graph = nearest_points(exec, {around.data(), std::int64_t(around.size() / 3)},
                                        {queries.data(), std::int64_t(tested.size())}, kNeighbours + 1);
  for (std::size_t q = 0; q < tested.size(); ++q) {
    const std::size_t i = tested[q];
    const std::array<double, 3> size = sorted_sizes(cloud, points.row[i]);
    const bool is_translucent = points.opacity[i] <= kSolid, is_needle = !is_translucent && size[2] > kLong * size[1];
    double object = 0;
    for (std::size_t k = 0; k < std::size_t(graph.neighbours); ++k)
      object += graph.index[q * std::size_t(graph.neighbours) + k] < of_object;
    const double share = object / kNeighbours;  // one of the nine may be the Gaussian itself
    const bool is_left = !is_needle && share >= (is_translucent ? kMinObjectShareTranslucent : kMinObjectShareSolid);
    debris[i] = is_left || occluder.contains(points.position[i]);
  }
  return debris;
}

}  // namespace ngs
