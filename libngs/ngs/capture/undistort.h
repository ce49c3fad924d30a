#pragma once
// Undistortion: resamples images of a lens to a pinhole camera.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/math/lens.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/mask_samples.h"

namespace ngs {

/// A camera with a lens; `camera` holds the intrinsics of both.
struct LensCamera {
  Camera camera;
  Lens lens;
};

/// The undistorted pinhole camera with the same pose and focal lengths whose image lies entirely within the photo: the
/// largest rectangle of the photo's proportions around the principal point, at most twice as wide and high as the
/// photo. Throws kBadInput if there is none, for example if the lens maps two directions near its axis to one pixel.
Camera undistorted_camera(const LensCamera& distorted);

enum class Resampling : std::uint8_t { kBilinear, kNearest };

/// [H, W, C] samples of camera `to` from a photo of the lens, which may have another size than its camera.
std::vector<std::uint16_t> undistorted(const Exec& exec, const MaskSamples& photo, const LensCamera& distorted,
                                       const Camera& to, Resampling resampling);

}  // namespace ngs
