#pragma once
// Pictures of a lens as a pinhole would have taken them.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/math/lens.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/mask_samples.h"

namespace ngs {

/// A camera with a lens; its intrinsics are those of both.
struct LensCamera {
  Camera camera;
  Lens lens;
};

/// The pinhole of the same place, axes and focal lengths whose picture lies wholly in that of the lens: the largest
/// rectangle of the photo's proportions about the principal point, at most twice as wide and high as the photo.
/// kBadInput: there is none, as where the lens maps two directions to one pixel near its axis.
Camera straight_camera(const LensCamera& distorted);

enum class Resampling : std::uint8_t { kBilinear, kNearest };

/// [H, W, C] of camera `to` from the samples of the lens, which may have another size than its camera.
std::vector<std::uint16_t> straightened(const Exec& exec, const MaskSamples& photo, const LensCamera& distorted,
                                        const Camera& to, Resampling resampling);

}  // namespace ngs
