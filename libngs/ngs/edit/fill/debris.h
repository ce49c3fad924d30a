#pragma once
// Finds debris: background Gaussians that exist only because of the object, such as translucent smears around it and
// Gaussians inside it.
#include <cstdint>
#include <vector>

#include "ngs/edit/fill/fill_surface.h"
#include "ngs/edit/fill/occluder.h"

namespace ngs {

/// [rim.background] 1: debris. Tested are Gaussians near the object, small relative to it, and in front of all
/// surfaces. Debris is a Gaussian inside the object, or one of whose 8 nearest solid neighbours 3/4 belong to the
/// object (1/2 if it is translucent). Opaque needles outside the object are kept: they show rods and edges.
std::vector<std::uint8_t> find_debris(const Exec& exec, const GaussianCloud& cloud, const Rim& rim,
                                      const Occluder& occluder, const std::vector<FillSurface>& surfaces);

}  // namespace ngs
