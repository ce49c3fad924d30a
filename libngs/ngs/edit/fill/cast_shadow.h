#pragma once
// The shadow that a removed object casts on a surface: the direction of the light is the one whose shadow of the object
// is darker than the surface next to it. Textures have no edge along that outline, so that medians of the colours on
// both sides cancel them.
#include "ngs/edit/fill/hole_cells.h"

namespace ngs {

struct CastShadow {
  orbit::Vec light{0, 0, 1};  // unit, towards the light
  double left = 1;            // ratio of the colour in the shadow to that next to it; 1: no shadow was found

  /// Factor in (0, 1] of the colour of a point of the surface: 1 in the light, `left` in the shadow.
  double at(const Occluder& occluder, orbit::Vec p) const;
};

/// The shadow on scene.surfaces[index], from the covered cells. The same for any number of threads.
CastShadow find_cast_shadow(const Exec& exec, const HoleScene& scene, std::size_t index, const HoleCells& cells);

}  // namespace ngs
