#pragma once
// Finds the surfaces that an object stood on or against: planes at the rim of its hole, or one curved ground.
#include <cstdint>
#include <vector>

#include "ngs/edit/fill/fill_options.h"
#include "ngs/edit/fill/rim.h"
#include "ngs/edit/fill/thin_plate.h"

namespace ngs {

struct FillSurface {
  orbit::Vec origin{0, 0, 0};                          // on the plane, world, relative to the model's origin
  orbit::Vec u{1, 0, 0}, v{0, 1, 0}, normal{0, 0, 1};  // right-handed; the normal points towards the object
  ThinPlate relief;                                    // height over the plane; empty: a plane
  double tolerance = 0;                                // world: maximum distance of the surface's Gaussians from it
  double spacing = 0;                                  // world: usual distance of neighbours on the surface
  double residual = 0;                                 // world: median distance of the rim's Gaussians from the surface
  std::int64_t rim_points = 0;                         // solid Gaussians on the surface near the object

  /// `unit_normal`: towards the object.
  void set_axes(orbit::Vec unit_normal) {
    normal = unit_normal;
    u = orbit::perpendicular(normal);
    v = cross(normal, u);
  }
  Vec2<double> coordinates(orbit::Vec p) const { return {dot(u, p - origin), dot(v, p - origin)}; }
  double height(orbit::Vec p) const {
    const Vec2<double> at = coordinates(p);
    return dot(normal, p - origin) - relief.at(at.x, at.y);
  }
  orbit::Vec point(double along_u, double along_v, double height) const {
    return origin + along_u * u + along_v * v + (height + relief.at(along_u, along_v)) * normal;
  }
};

/// At most four surfaces, those with most rim points first. None if the rim has fewer than 12 solid Gaussians, if they
/// are on one line, or if every plane through them cuts through the object. The same bytes for any number of threads.
std::vector<FillSurface> find_fill_surfaces(const Exec& exec, const GaussianCloud& cloud, const Rim& rim, FillKind kind,
                                            std::uint64_t seed);

/// The planes at the rim of an object that the object stands on or against: at least 98 % of its Gaussians are in front
/// of the plane. `object` [N] 1: belongs to the object.
std::vector<FillSurface> supporting_planes(const Exec& exec, const GaussianCloud& cloud,
                                           const std::vector<std::uint8_t>& object, std::uint64_t seed);

}  // namespace ngs
