#pragma once
// Finds the shadow that a removed object cast on a surface. Each direction of the light predicts an outline of the
// shadow; the best direction has the clearest drop in brightness across its outline. The drop is a median along the
// outline, so the surface's texture, which has no edge there, cancels out.
#include "ngs/edit/fill/hole_cells.h"

namespace ngs {

struct CastShadow {
  orbit::Vec light{0, 0, 1};  // unit, towards the light
  double shadow_factor = 1;   // brightness in the shadow divided by brightness next to it; 1: no shadow was found

  /// Brightness factor of the surface point `p`: 1 in the light, `shadow_factor` in full shadow.
  double at(const Occluder& occluder, orbit::Vec p) const;
};

/// The shadow on scene.surfaces[index], from the covered cells. The same for any number of threads.
CastShadow find_cast_shadow(const Exec& exec, const HoleScene& scene, std::size_t index, const HoleCells& cells);

}  // namespace ngs
