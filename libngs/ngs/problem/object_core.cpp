#include "ngs/problem/object_core.h"

#include <algorithm>
#include <cmath>

#include "ngs/ops/neighbours/knn.h"

namespace ngs {

ObjectCore core_of(const CoreOptions& options, const GaussianCloud& cloud, std::span<const LabelColumns> objects) {
  const auto n = std::size_t(cloud.size());
  ObjectCore core{.member = std::vector<std::uint8_t>(n, 0)};
  float max_views = 0;
  for (const LabelColumns& object : objects)
    for (std::size_t i = 0; i < n; ++i)
      if (cloud.usable[i] && double(object.prob[i]) >= options.share) max_views = std::max(max_views, object.views[i]);
  core.min_views = std::ceil(options.seen * double(max_views));
  for (std::size_t i = 0; i < n; ++i) {
    if (!cloud.usable[i]) continue;
    for (const LabelColumns& object : objects)
      if (object.views[i] > 0 && double(object.views[i]) >= core.min_views && double(object.prob[i]) >= options.share)
        core.member[i] = 1;
    if (!core.member[i]) continue;
    ++core.count;
    for (std::size_t a = 0; a < 3; ++a) core.centre[a] += double(cloud.position[3 * i + a]);
  }
  if (core.count == 0) return core;
  for (double& x : core.centre) x /= double(core.count);
  // E[x²] - |centre|² would lose a core that is small against its distance from the origin.
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t a = 0; a < 3 && core.member[i]; ++a) {
      const double offset = double(cloud.position[3 * i + a]) - core.centre[a];
      squares += offset * offset;
    }
  core.radius = std::sqrt(squares / double(core.count));
  return core;
}

std::vector<float> core_centres(const GaussianCloud& cloud, const ObjectCore& core) {
  std::vector<float> centres;
  for (std::size_t i = 0; i < core.member.size(); ++i)
    if (core.member[i]) centres.insert(centres.end(), &cloud.position[3 * i], &cloud.position[3 * i] + 3);
  return centres;
}

double core_margin(const Exec& exec, const CoreOptions& options, const GaussianCloud& cloud, const ObjectCore& core) {
  const std::vector<float> centres = core_centres(cloud, core);
  const double spacing = mean_spacing(nearest_others(exec, {centres.data(), core.count}, 3));
  return std::max(options.margin * core.radius, options.spacings * spacing);
}

}  // namespace ngs
