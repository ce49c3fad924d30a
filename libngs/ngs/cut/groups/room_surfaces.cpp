#include "ngs/cut/groups/room_surfaces.h"

#include <algorithm>
#include <cmath>

#include "ngs/math/vectors.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs {
namespace {

using V = Vec3<double>;

constexpr double kLarge = 0.5;       // least extent of a surface in both directions, radii of the bulk
constexpr double kFlat = 0.1;        // maximum distance from the plane, relative to the smaller extent
constexpr double kMost = 0.8;        // share of the area that must be so near to the plane
constexpr double kMaxBehind = 0.03;  // maximum share of the model's area behind the surface

/// Points and their areas; the largest Gaussians count as discs of a tenth of the bulk's radius.
struct Points {
  orbit::SurfacePoints all;
  double radius = 0, area = 0;
};

class Surface {
 public:
  Surface(const Points& points, const std::vector<std::size_t>& of) : points_(points), of_(of) {
    for (const std::size_t i : of) weight_.push_back(points.all.area[i]);
  }

  double quantile(V along, double share) const {
    std::vector<double> value;
    for (const std::size_t i : of_) value.push_back(dot(along, points_.all.position[i]));
    return orbit::weighted_quantile(value, weight_, share);
  }
  double extent(V along) const { return quantile(along, 0.95) - quantile(along, 0.05); }

  /// The horizontal direction of least variance.
  V thin_direction(V up) const {
    const V a = orbit::perpendicular(up), b = cross(up, a);
    double sum = 0, ma = 0, mb = 0, aa = 0, ab = 0, bb = 0;
    for (std::size_t k = 0; k < of_.size(); ++k) {
      const double w = weight_[k], x = dot(a, points_.all.position[of_[k]]), y = dot(b, points_.all.position[of_[k]]);
      sum += w;
      ma += w * x;
      mb += w * y;
      aa += w * x * x;
      ab += w * x * y;
      bb += w * y * y;
    }
    const double xx = aa - ma * ma / sum, yy = bb - mb * mb / sum, xy = ab - ma * mb / sum;
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);  // direction of the largest variance
    return -std::sin(angle) * a + std::cos(angle) * b;
  }

  bool is_large_plane(V normal) const {
    const V a = orbit::perpendicular(normal), b = cross(normal, a);
    const double smaller = std::min(extent(a), extent(b));
    if (smaller < kLarge * points_.radius) return false;
    const double middle = quantile(normal, 0.5);
    std::vector<double> distance;
    for (const std::size_t i : of_) distance.push_back(std::abs(dot(normal, points_.all.position[i]) - middle));
    if (orbit::weighted_quantile(distance, weight_, kMost) > kFlat * smaller) return false;
    double below = 0, above = 0;
    for (std::size_t i = 0; i < points_.all.count(); ++i) {
      const double height = dot(normal, points_.all.position[i]) - middle;
      if (height > kFlat * smaller) above += points_.all.area[i];
      if (height < -kFlat * smaller) below += points_.all.area[i];
    }
    return std::min(below, above) <= kMaxBehind * points_.area;
  }

 private:
  const Points& points_;
  const std::vector<std::size_t>& of_;
  std::vector<double> weight_;
};

}  // namespace

std::size_t remove_room_surfaces(const GaussianCloud& cloud, V up, GroupedObjects& objects) {
  Points points{orbit::surface_points(cloud)};
  if (points.all.count() == 0) return 0;
  points.radius = orbit::bulk_of(points.all).radius;
  for (double& area : points.all.area) {
    area = std::min(area, 0.01 * points.radius * points.radius);
    points.area += area;
  }
  std::vector<std::vector<std::size_t>> of(objects.objects.size());
  for (std::size_t i = 0; i < points.all.count(); ++i)
    if (const std::uint32_t k = objects.object[points.all.row[i]]; k > 0) of[k - 1].push_back(i);
  std::vector<std::uint32_t> number(of.size() + 1);
  std::vector<GroupedObject> kept;
  std::size_t sure = 0;
  for (std::size_t k = 0; k < of.size(); ++k) {
    const Surface surface(points, of[k]);
    if (!of[k].empty() && (surface.is_large_plane(up) || surface.is_large_plane(surface.thin_direction(up)))) continue;
    sure += k < objects.sure;
    kept.push_back(std::move(objects.objects[k]));
    number[k + 1] = std::uint32_t(kept.size());
  }
  for (std::uint32_t& object : objects.object) object = number[object];
  for (GroupedObject& object : kept) {
    object.part_of = number[object.part_of];
    if (object.part_of == 0) object.part_share = 0;
  }
  const std::size_t removed = objects.sure - sure;
  objects.objects = std::move(kept);
  objects.sure = sure;
  return removed;
}

}  // namespace ngs
