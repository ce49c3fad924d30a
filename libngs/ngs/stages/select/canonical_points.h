#pragma once
// The points of a model in an order that its content decides, so that what samples them in order finds the same in a
// file whose rows were shuffled.
#include "ngs/stages/orbit/surface_points.h"

namespace ngs {

/// surface_points() of the Gaussians with member[i] != 0 (empty: of all), ordered by a hash of their positions: any
/// stretch of it is a fair sample. Those of one position are ordered by opacity and area.
orbit::SurfacePoints canonical_points(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member = {});

}  // namespace ngs
