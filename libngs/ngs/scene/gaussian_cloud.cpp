#include "ngs/scene/gaussian_cloud.h"

#include <cmath>
#include <span>

namespace ngs {
namespace {

bool all_finite(std::span<const float> values) {
  for (const float v : values)
    if (!std::isfinite(v)) return false;
  return true;
}

}  // namespace

CloudHealth classify(GaussianCloud& cloud) {
  CloudHealth health;
  health.total = cloud.size();
  cloud.usable.assign(std::size_t(cloud.size()), 1);
  const std::size_t rest = std::size_t(cloud.rest_count()) * 3;
  for (std::size_t i = 0; i < cloud.usable.size(); ++i) {
    const std::span<const float> scale(&cloud.log_scale[i * 3], 3), rotation(&cloud.rotation[i * 4], 4);
    bool scale_is_absurd = false, scale_is_nan = false;
    for (const float s : scale) {
      scale_is_nan |= std::isnan(s);
      scale_is_absurd |= s > kMaxLogScale || s == -INFINITY;
    }
    const bool finite = all_finite({&cloud.position[i * 3], 3}) && all_finite(rotation) && !scale_is_nan &&
                        !std::isnan(cloud.logit_opacity[i]) && all_finite({&cloud.sh_dc[i * 3], 3}) &&
                        all_finite({cloud.sh_rest.data() + i * rest, rest});
    if (!finite)
      ++health.non_finite;
    else if (scale_is_absurd)
      ++health.absurd_scale;
    else if (rotation[0] == 0 && rotation[1] == 0 && rotation[2] == 0 && rotation[3] == 0)
      ++health.zero_rotation;
    cloud.usable[i] = finite && !scale_is_absurd;
  }
  return health;
}

}  // namespace ngs
