#include "ngs/edit/select/region.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/edit/select/canonical_points.h"
#include "ngs/orbit/orbit_stage.h"

namespace ngs {
namespace {

using orbit::Vec;

struct NumberList {
  const char* flag;
  const char* form;  // "X,Y,Z,R"
  const std::string& text;

  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(ErrorCode::kUsage, std::string(flag) + " = " + text + ", expected " + expected);
  }

  template <std::size_t kCount>
  std::array<double, kCount> numbers() const {
    std::array<double, kCount> values{};
    const char *at = text.data(), *const end = at + text.size();
    for (std::size_t k = 0; k < kCount; ++k) {
      const auto [stop, status] = scan_number(at, end, values[k]);
      const bool last = k + 1 == kCount;
      if (status != std::errc() || !std::isfinite(values[k]) || (last ? stop != end : stop == end || *stop != ','))
        fail(std::string(form) + ": " + std::to_string(kCount) + " finite numbers with commas between them");
      at = stop + 1;
    }
    return values;
  }
};

Region::Box parse_box(const std::string& text) {
  const NumberList list{"keep_box", "X,Y,Z,X,Y,Z", text};
  const auto v = list.numbers<6>();
  const Region::Box box{{std::min(v[0], v[3]), std::min(v[1], v[4]), std::min(v[2], v[5])},
                        {std::max(v[0], v[3]), std::max(v[1], v[4]), std::max(v[2], v[5])}};
  if (v[0] == v[3] || v[1] == v[4] || v[2] == v[5]) list.fail("two corners that differ in x, y and z");
  return box;
}

orbit::Ball parse_sphere(const std::string& text) {
  const NumberList list{"keep_sphere", "X,Y,Z,R", text};
  const auto v = list.numbers<4>();
  if (!(v[3] > 0)) list.fail("a radius above 0");
  return {{v[0], v[1], v[2]}, v[3]};
}

Region::HalfSpace parse_plane(const std::string& text) {
  const NumberList list{"drop_below_plane", "auto or A,B,C,D", text};
  const auto v = list.numbers<4>();
  const double norm = std::hypot(v[0], v[1], v[2]);
  if (!(norm > 0) || !std::isfinite(norm)) list.fail("a normal A,B,C that is not 0");
  return {{v[0] / norm, v[1] / norm, v[2] / norm}, v[3] / norm};
}

Vec position_of(const GaussianCloud& cloud, std::size_t i) {
  const float* p = &cloud.position[3 * i];
  return Vec{p[0], p[1], p[2]};
}

bool within(const Region& region, Vec p) {
  if (region.boxes.empty() && region.balls.empty()) return true;
  for (const auto& [low, high] : region.boxes)
    if (p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z) return true;
  for (const orbit::Ball& ball : region.balls)
    if (length(p - ball.centre) <= ball.radius) return true;
  return false;
}

Vec up_of(UpAxis axis, const orbit::SurfacePoints& points) {
  if (axis != UpAxis::kAuto || points.count() == 0) return orbit::axis_of(axis);
  return orbit::guess_up(points, orbit::bulk_of(points)).up;
}

SupportPlane support_plane(const RegionOptions& options, const GaussianCloud& cloud,
                           const std::vector<std::uint8_t>& member) {
  const orbit::SurfacePoints points = canonical_points(cloud, member);
  const SupportPlane plane = find_support_plane(cloud, points, up_of(options.up, points));
  if (!supports_object(cloud, points, plane))
    throw Error(ErrorCode::kNothingFound,
                "--drop-below-plane auto: no supporting plane among " + std::to_string(points.count()) +
                    " Gaussians, expected a floor, a table or a pedestal",
                "leave --drop-below-plane out if nothing lies below the object; else give the plane, A,B,C,D, or the "
                "axis that points upwards: --up");
  return plane;
}

/// The cluster of the Gaussian nearest to the point; -1: none. Ties go to the larger cluster.
std::int32_t cluster_near(const GaussianCloud& cloud, const Clusters& clusters, Vec point) {
  double nearest = std::numeric_limits<double>::infinity();
  std::int32_t found = -1;
  for (std::size_t i = 0; i < clusters.of_row.size(); ++i) {
    const std::int32_t c = clusters.of_row[i];
    if (c < 0) continue;
    const Vec offset = position_of(cloud, i) - point;
    const double distance2 = dot(offset, offset);
    if (distance2 < nearest || (distance2 == nearest && c < found)) {
      nearest = distance2;
      found = c;
    }
  }
  return found;
}

void keep_clusters(const Exec& exec, const RegionOptions& options, const Region& region, const GaussianCloud& cloud,
                   RegionSelection& out) {
  const Clusters clusters = cluster_on_grid(exec, cloud, out.object, options.cluster_side);
  out.clusters = std::int64_t(clusters.size.size());
  out.cluster_side = clusters.side;
  std::vector<std::uint8_t> wanted(clusters.size.size(), 0);
  std::fill_n(wanted.begin(), std::min(std::size_t(options.largest), wanted.size()), std::uint8_t(1));
  const Vec origin{cloud.origin[0], cloud.origin[1], cloud.origin[2]};
  for (const Vec& point : region.cluster_at)
    if (const std::int32_t c = cluster_near(cloud, clusters, point - origin); c >= 0) wanted[std::size_t(c)] = 1;
  for (std::size_t i = 0; i < out.object.size(); ++i) {
    const std::int32_t c = clusters.of_row[i];
    out.object[i] = c >= 0 && wanted[std::size_t(c)];
  }
}

}  // namespace

Region parse_region(const RegionOptions& options) {
  Region region;
  for (const std::string& text : options.keep_box) region.boxes.push_back(parse_box(text));
  for (const std::string& text : options.keep_sphere) region.balls.push_back(parse_sphere(text));
  region.above_support = options.drop_below_plane == "auto";
  if (!region.above_support && !options.drop_below_plane.empty()) region.above = parse_plane(options.drop_below_plane);
  for (const std::string& text : options.cluster_at) {
    const auto v = NumberList{"cluster_at", "X,Y,Z", text}.numbers<3>();
    region.cluster_at.push_back({v[0], v[1], v[2]});
  }
  return region;
}

RegionSelection select_region(const Exec& exec, const RegionOptions& options, const GaussianCloud& cloud,
                              const std::vector<std::uint8_t>& member) {
  NGS_CHECK(std::int64_t(member.size()) == cloud.size(), "one entry per Gaussian");
  const Region region = parse_region(options);
  RegionSelection out;
  out.object.assign(member.size(), 0);
  const Vec origin{cloud.origin[0], cloud.origin[1], cloud.origin[2]};
  const auto keep_where = [&](const auto& inside) {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < out.object.size(); ++i)
      count += out.object[i] = out.object[i] && inside(position_of(cloud, i));
    return count;
  };
  for (std::size_t i = 0; i < member.size(); ++i) out.object[i] = member[i] && cloud.usable[i];
  out.above_plane = out.in_shapes = keep_where([&](Vec p) { return within(region, origin + p); });
  if (region.above)
    out.above_plane =
        keep_where([&](Vec p) { return dot(region.above->normal, origin + p) + region.above->offset > 0; });
  if (region.above_support && out.in_shapes > 0) {
    out.plane = support_plane(options, cloud, out.object);
    out.above_plane =
        keep_where([&](Vec p) { return dot(out.plane.normal, p) > out.plane.offset + out.plane.thickness; });
  }
  if (!region.cluster_at.empty() || options.largest > 0) keep_clusters(exec, options, region, cloud, out);
  return out;
}

}  // namespace ngs
