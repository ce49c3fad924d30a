#pragma once
// The scene `messy`: a room with a table and a rack of shelves, full of objects that touch, stand on each other or lie
// in crates, some thin or concave, some in the colours of others.
//
// Furniture has id 0, as the room has. Solids of two objects meet at most in surfaces.
#include <cstdint>

#include "ngs/make/synth/analytic_scene.h"

namespace ngs::synth {

/// Sets objects, focus and rig radius of a scene: objects 0 to `count` - 1, then the furniture. `count` >= 1; the
/// furniture and the floor grow with it.
void messy_room(AnalyticScene& scene, int count, std::uint64_t seed);

}  // namespace ngs::synth
