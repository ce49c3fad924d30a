#pragma once
// Adds Gaussians at hole pixels that no surface covers; their depth is interpolated from the surroundings.
#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/rendered_view.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

/// One view of a background with a hole.
struct HolePicture {
  const Camera& camera;        // relative to the origin of the seeds' model
  const RenderedView& around;  // the background: depth and alpha
  const PixelMask& hole;       // [H·W] 1: to be filled
  const ImageF& picture;       // [H, W, 3] what the hole shall show
};

/// Appends a Gaussian with the mean colour for each cell of 4 x 4 pixels that is less than half covered and has its
/// centre in the hole. The inverse depth is interpolated harmonically between covered cells, which is exact for planes.
/// Cells that are not connected to a covered cell are skipped. `to` keeps its SH degree. Returns the number.
std::int64_t add_hole_seeds(const HolePicture& view, GaussianCloud& to);

}  // namespace ngs
