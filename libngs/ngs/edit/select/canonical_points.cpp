#include "ngs/edit/select/canonical_points.h"

#include <algorithm>
#include <tuple>

#include "ngs/core/check.h"

namespace ngs {
namespace {

/// The sort key of a usable Gaussian. All its values are finite, except that the opacity logit may be infinite.
auto key_of(const GaussianCloud& cloud, std::size_t i) {
  const float *p = &cloud.position[3 * i], *s = &cloud.log_scale[3 * i];
  return std::tuple(p[2], p[1], p[0], cloud.logit_opacity[i], s[0], s[1], s[2]);
}

}  // namespace

std::vector<std::uint32_t> canonical_rows(const GaussianCloud& cloud) {
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i)
    if (cloud.usable[i]) rows.push_back(std::uint32_t(i));
  std::sort(rows.begin(), rows.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key_of(cloud, a) < key_of(cloud, b); });
  return rows;
}

orbit::SurfacePoints canonical_points(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member) {
  NGS_CHECK(member.empty() || std::int64_t(member.size()) == cloud.size(), "one entry per Gaussian");
  const orbit::SurfacePoints all = orbit::surface_points(cloud);
  constexpr std::uint32_t kNone = std::uint32_t(-1);
  std::vector<std::uint32_t> point_of(std::size_t(cloud.size()), kNone);
  for (std::size_t k = 0; k < all.count(); ++k)
    if (member.empty() || member[all.row[k]]) point_of[all.row[k]] = std::uint32_t(k);
  orbit::SurfacePoints out;
  for (const std::uint32_t row : canonical_rows(cloud))
    if (const std::uint32_t k = point_of[row]; k != kNone) out.add(all, k);
  return out;
}

}  // namespace ngs
