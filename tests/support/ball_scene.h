#pragma once
// The tiny scene's ball without the wall: an object without background, as in product shots and NeRF's synthetic
// scenes.
#include <string>

#include "ngs/math/vec.h"

namespace ngs::test {

/// Writes into `folder`: model.ply (the ball with slightly wrong colours), text/*.txt (COLMAP), masks/vI.png, and
/// images/vI.png (the ball over `behind`, RGB).
void write_ball_scene(const std::string& folder, Vec3<float> behind);

/// The same with transparent photos whose hidden colours (alpha 0) are those of a room, and a model with blobs that are
/// visible over any `behind` except one of their colour.
void write_cut_out_ball_scene(const std::string& folder, Vec3<float> behind);

}  // namespace ngs::test
