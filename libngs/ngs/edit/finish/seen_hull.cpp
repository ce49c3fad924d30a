#include "ngs/edit/finish/seen_hull.h"

#include <algorithm>
#include <cmath>

#include "ngs/math/row_numbers.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/orbit/rigs.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs::finish {
namespace {

constexpr std::size_t kDirections = 40;
constexpr int kSide_px = 384, kNeighbours = 16;
constexpr double kFov_deg = 40, kShown = 2;  // radii of the object that an image shows
constexpr double kSeenNeighbours = 0.8;      // minimum share of seen neighbours
constexpr double kFar = 0.45;                // radii of the object: distance of a far Gaussian from all seen ones
constexpr double kMostFar = 0.01;            // maximum share of far Gaussians; more of them are an unseen side
constexpr double kOutsideShare = 0.05;       // share of the directions that must show a point outside
constexpr int kMinOutside = 2;

/// [queries] the distance to the nearest of the points, world.
std::vector<double> nearest_distances(const Exec& exec, const std::vector<float>& points,
                                      const std::vector<float>& queries) {
  const KnnGraph graph = nearest_points(exec, {points.data(), std::int64_t(points.size() / 3)},
                                        {queries.data(), std::int64_t(queries.size() / 3)}, 1);
  std::vector<double> distance;
  for (std::size_t q = 0; 3 * q < queries.size(); ++q) {
    const float *p = &queries[3 * q], *at = &points[3 * std::size_t(graph.index[q])];
    distance.push_back(std::hypot(double(at[0]) - p[0], double(at[1]) - p[1], double(at[2]) - p[2]));
  }
  return distance;
}

/// [object] 1: hidden, among neighbours most of which are seen, or farther than `far` from all seen ones.
std::vector<std::uint8_t> surplus_rows(const Exec& exec, const GaussianCloud& object,
                                       const std::vector<std::uint8_t>& seen, double far) {
  std::vector<std::uint8_t> surplus(seen.size());
  std::vector<float> points, queries, visible;
  std::vector<std::size_t> of_point, of_query;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!object.usable[i]) continue;
    of_point.push_back(i);
    points.insert(points.end(), &object.position[3 * i], &object.position[3 * i] + 3);
    std::vector<float>& part = seen[i] ? visible : queries;
    part.insert(part.end(), &object.position[3 * i], &object.position[3 * i] + 3);
    if (!seen[i]) of_query.push_back(i);
  }
  if (of_query.empty() || of_point.size() <= std::size_t(kNeighbours)) return surplus;
  const KnnGraph graph = nearest_points(exec, {points.data(), std::int64_t(of_point.size())},
                                        {queries.data(), std::int64_t(of_query.size())}, kNeighbours + 1);
  for (std::size_t q = 0; q < of_query.size(); ++q) {
    int count = 0;
    for (std::size_t k = 0; k < std::size_t(graph.neighbours); ++k)
      count += seen[of_point[std::size_t(graph.index[q * std::size_t(graph.neighbours) + k])]];  // itself: 0
    surplus[of_query[q]] = count >= kSeenNeighbours * kNeighbours;
  }
  if (visible.empty()) return surplus;
  const std::vector<double> distance = nearest_distances(exec, visible, queries);
  const auto is_far = [&](double d) { return d > far; };
  if (double(std::ranges::count_if(distance, is_far)) > kMostFar * double(of_point.size())) return surplus;
  for (std::size_t q = 0; q < of_query.size(); ++q) surplus[of_query[q]] |= std::uint8_t(is_far(distance[q]));
  return surplus;
}

}  // namespace

SeenHull::SeenHull(const Exec& exec, const GaussianCloud& object, const std::vector<std::uint8_t>& seen,
                   const orbit::Ball& ball)
    : seen_(seen), surplus_(surplus_rows(exec, object, seen, kFar * ball.radius)), ball_(ball) {
  if (std::ranges::find(surplus_, std::uint8_t(1)) == surplus_.end()) return;
  const std::vector<std::int64_t> rows = RowNumbers(seen).row;
  const GaussianCloud core = gather_rows(exec, object, rows);
  const std::vector<std::uint8_t> all(rows.size(), 1);
  SplatOptions splat;
  splat.compat = Compat::kGsplat;  // for its nearer near plane
  splat.max_sh_degree = 0;
  splat.antialiased = object.antialiased;
  splat.world_unit = world_unit_for(ball.radius, near_plane(Compat::kGsplat));
  const orbit::Intrinsics intrinsics{kSide_px, kSide_px, kFov_deg};
  const double distance = kShown * ball.radius / intrinsics.least_half_sine();
  const orbit::Frame frame{.centre = ball.centre};
  const ObjectLabels labels(core, {all});
  const SplatOptions prepared = prepared_for(exec, splat, core);
  for (const orbit::Vec direction : orbit::even_directions(kDirections)) {
    const Camera camera = orbit::camera_at({distance * direction, {0, 0, 0}}, intrinsics, frame, object.origin);
    views_.emplace_back(FinishModel{core, all}, camera, RenderedObject{labels.render(exec, prepared, camera)},
                        std::vector<GivenMask>());
  }
}

bool SeenHull::contains(Vec3<double> point) const {
  if (length(point - ball_.centre) > kShown * ball_.radius) return true;
  int outside = 0;
  for (const SupportView& view : views_) {
    const PointStatus status = view.statuses(point, 0).rendered;
    outside += status == PointStatus::kVisibleOutside || status == PointStatus::kUnknown;
  }
  return outside < std::max(kMinOutside, int(kOutsideShare * double(views_.size())));
}

}  // namespace ngs::finish
