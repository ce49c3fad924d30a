#pragma once
// Masks of everything: label maps whose ids mean nothing in other views, and the Gaussians that each mask shows.
#include <cstdint>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/camera.h"

namespace ngs {

/// The masks of one view.
struct NumberedMasks {
  static constexpr std::uint16_t kUnknown = 0xFFFF;
  ImageU16 number;  // [H, W, 1] 0: in no mask, 1 .. masks, or kUnknown; empty: the view has no masks
  int masks = 0;
};

struct MaskedGaussian {
  std::uint32_t gaussian;
  std::uint32_t mask;  // 0: most of its weight lies outside all masks
  float weight;        // Σ α T over the known pixels, px
  float visibility;    // mean α T over the pixels that it reaches, in (0, 1]
};

/// The Gaussians of one view that lie in one mask, or outside all, with more than half of their weight.
struct ViewGaussians {
  int masks = 0;
  std::vector<MaskedGaussian> seen;  // ascending by Gaussian
};

/// Empty for a view without masks. `masks.number` has the camera's size.
ViewGaussians view_gaussians(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                             const SplatOptions& splat, const NumberedMasks& masks);

/// Removes Gaussians from views in which others hide them: those with less than `share` of their largest visibility in
/// any view. `gaussians`: the number of the model's.
void keep_unhidden(const Exec& exec, std::size_t gaussians, double share, std::vector<ViewGaussians>& views);

}  // namespace ngs
