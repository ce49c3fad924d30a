#pragma once
// Gaussians for the pixels of a hole that no surface explains: at the depth that continues its surroundings smoothly.
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

/// Appends a Gaussian for each cell of 4 x 4 pixels whose centre is in the hole and less than half covered, with the
/// cell's mean colour. Its inverse depth is harmonic in the image between the covered cells, which continues planes
/// exactly. Cells that no covered cell reaches through such cells get none. `to` keeps its degree. Returns the number.
std::int64_t add_hole_seeds(const HolePicture& view, GaussianCloud& to);

}  // namespace ngs
