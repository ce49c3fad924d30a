#pragma once
// A capture small enough to be made by every test: a red ball of 150 Gaussians in front of a wall of 224, seen by six
// cameras of 48 x 36 px, the last one held out. Photos and masks are rendered by libngs.
#include <string>
#include <vector>

#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::test {

struct TinyScene {
  GaussianCloud cloud;
  std::vector<float> is_object;  // [N]
  std::vector<Camera> cameras;
};
TinyScene tiny_scene();

/// Adds lattices of 3000 Gaussians that no view sees, as most of a large model is; the nearest of them are nearer to
/// the ball than to the wall.
void add_unseen(GaussianCloud& cloud);

/// Writes into `folder`: model.ply (strict), scene.json, images/vI.png, masks/vI.png (0/255), labels/vI.png
/// (object 7), sparse/0/*.bin (COLMAP), text/*.txt (the same), transforms.json, cameras.json (Inria).
void write_tiny_scene(const std::string& folder);

/// A strict PLY, written independently of the library's writer.
std::string strict_ply_bytes(const GaussianCloud& cloud);

}  // namespace ngs::test
