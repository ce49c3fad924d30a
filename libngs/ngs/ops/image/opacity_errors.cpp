#include "ngs/ops/image/opacity_errors.h"

#include <string>

#include "ngs/core/error.h"

namespace ngs {
OpacityErrors opacity_errors(const std::vector<float>& opacity, MaskPlane silhouette, MaskPlane occluders) {
  const std::vector<std::int32_t> inside = signed_distance(silhouette),
                                  occluder = occluders.data == nullptr
                                                 ? std::vector<std::int32_t>(opacity.size(), -kUnbounded)
                                                 : signed_distance(occluders);
  OpacityErrors errors;
  for (std::size_t i = 0; i < opacity.size(); ++i) {
    const double a = double(opacity[i]);
    if (!(a >= 0 && a <= 1))
      throw Error(ErrorCode::kNumeric, "opacity " + std::to_string(a) + ", expected a number in [0, 1]");
    if (-occluder[i] <= kOccluderMargin_px) continue;
    errors.contour_px += inside[i] == 1;
    for (std::size_t b = 0; b < kHaloBands_px.size(); ++b) {
      if (-inside[i] > kHaloBands_px[b]) errors.halo_px[b] += a;
      if (inside[i] > kHaloBands_px[b]) errors.holes_px[b] += 1 - a;
    }
  }
  for (auto* sums : {&errors.halo_px, &errors.holes_px})
    for (double& sum : *sums) sum = errors.contour_px > 0 ? sum / errors.contour_px : 0;
  return errors;
}

}  // namespace ngs
