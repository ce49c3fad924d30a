#include "ngs/ops/image/opacity_errors.h"

#include <string>

#include "ngs/core/error.h"

namespace ngs {
namespace {

std::vector<std::uint8_t> inverted(MaskPlane mask) {
  std::vector<std::uint8_t> out(std::size_t(mask.pixels()));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = mask.data[i] == 0;
  return out;
}

/// Distance [H, W] to the nearest pixel of the mask; 0 inside.
std::vector<std::int32_t> distance_to(MaskPlane mask) {
  const std::vector<std::uint8_t> others = inverted(mask);
  return chessboard_distance({others.data(), mask.width_px, mask.height_px}, Outside::kUnknown);
}

}  // namespace

OpacityErrors opacity_errors(const std::vector<float>& opacity, MaskPlane silhouette, MaskPlane occluders) {
  const std::vector<std::int32_t> outside = distance_to(silhouette),
                                  inside = chessboard_distance(silhouette, Outside::kUnknown);
  const std::vector<std::int32_t> occluder =
      occluders.data == nullptr ? std::vector<std::int32_t>(opacity.size(), kUnbounded) : distance_to(occluders);
  OpacityErrors errors;
  for (std::size_t i = 0; i < opacity.size(); ++i) {
    const double a = double(opacity[i]);
    if (!(a >= 0 && a <= 1))
      throw Error(ErrorCode::kNumeric, "opacity " + std::to_string(a) + ", expected a number in [0, 1]");
    if (occluder[i] <= kOccluderMargin_px) continue;
    errors.contour_px += inside[i] == 1;
    for (std::size_t b = 0; b < kHaloBands_px.size(); ++b) {
      if (outside[i] > kHaloBands_px[b]) errors.halo_px[b] += a;
      if (inside[i] > kHaloBands_px[b]) errors.holes_px[b] += 1 - a;
    }
  }
  for (auto* sums : {&errors.halo_px, &errors.holes_px})
    for (double& sum : *sums) sum = errors.contour_px > 0 ? sum / errors.contour_px : 0;
  return errors;
}

}  // namespace ngs
