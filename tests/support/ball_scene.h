#pragma once
// The tiny scene's ball without the wall: an object on nothing, as product shots and NeRF's synthetic scenes show it.
#include <string>

#include "ngs/math/vec.h"

namespace ngs::test {

/// Writes into `folder`: model.ply (the ball, a little off in colour), text/*.txt (COLMAP), masks/vI.png, and
/// images/vI.png: the ball over `behind`, as RGB.
void write_ball_scene(const std::string& folder, Vec3<float> behind);

/// The same with transparent photos that keep the colours of a room under alpha 0, and a model with blobs that only
/// a `behind` of their own colour hides.
void write_cut_out_ball_scene(const std::string& folder, Vec3<float> behind);

}  // namespace ngs::test
