#pragma once
// Converts GaussianCloud and Camera to the form of the float kernels. Internal to ops.
#include <algorithm>

#include "ngs/ops/splat/splat_gaussian.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

inline CloudView<float> cloud_view(const GaussianCloud& cloud, int max_sh_degree, const std::uint8_t* include) {
  return {cloud.size(),
          cloud.position.data(),
          cloud.rotation.data(),
          cloud.log_scale.data(),
          cloud.logit_opacity.data(),
          cloud.sh_dc.data(),
          cloud.sh_rest.data(),
          std::min(cloud.sh_degree, max_sh_degree),
          cloud.rest_count(),
          cloud.usable.data(),
          include};
}

/// The camera in coordinates relative to the cloud's origin.
inline Camera relative_camera(const Camera& camera, const GaussianCloud& cloud) {
  return relative_to(camera, cloud.origin);
}

}  // namespace ngs
