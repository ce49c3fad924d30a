#pragma once
// The surface of a splat in renderings from all around: where each pixel's ray meets it, its orientation and colour.
#include <array>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::mesh {

/// SurfaceView::depth of a pixel that shows the inside of a shell: the object is open there, for example at its base.
inline constexpr float kSeenFromWithin = -1;

/// The surface in one rendering. Everything is relative to the model's origin.
struct SurfaceView {
  Camera camera;
  ImageU8 alpha;                                   // [H, W, 1] 255: opaque
  ImageF depth;                                    // [H, W, 1] camera z of the surface, world; 0: alpha below 1/2
  std::vector<std::array<std::int8_t, 3>> normal;  // [H W] camera axes, 127 is 1, towards the camera; 0: no surface
  ImageU8 colour;                                  // [H, W, 3] sRGB; divided by alpha

  std::size_t pixels() const { return normal.size(); }
  /// The surface point of a pixel, relative to the model's origin.
  Vec3<double> point(std::size_t pixel) const;
};

struct SurfaceRig {
  std::vector<Vec3<double>> directions;  // from the object to the cameras, unit length
  orbit::Ball ball;                      // fills the pictures
  int side_px = 512;
};

/// Renders the model from every direction. The depth of a pixel is that of the plane Σ w n (x - m) = 0 on its ray, over
/// the Gaussians of the pixel with weights w = α T: m is a Gaussian's centre, and n the direction in which its density
/// falls fastest towards the camera (for a disc, its normal). A flat surface thus has its exact depth also where large
/// Gaussians are seen at an angle. Results do not depend on exec.threads.
std::vector<SurfaceView> render_surface_views(const Exec& exec, const GaussianCloud& cloud, const SurfaceRig& rig);

}  // namespace ngs::mesh
