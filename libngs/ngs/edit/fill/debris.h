#pragma once
// Gaussians of the background that existed only because of the object: half-transparent smears around it, and what it
// enclosed.
#include <cstdint>
#include <vector>

#include "ngs/edit/fill/fill_surface.h"
#include "ngs/edit/fill/occluder.h"

namespace ngs {

/// [rim.background] 1: the Gaussian is off all surfaces, small enough to be within the object's place, and most of its
/// eight nearest solid neighbours were the object; or, half-transparent or a needle, at least half of them.
std::vector<std::uint8_t> find_debris(const Exec& exec, const GaussianCloud& cloud, const Rim& rim,
                                      const Occluder& occluder, const std::vector<FillSurface>& surfaces);

}  // namespace ngs
