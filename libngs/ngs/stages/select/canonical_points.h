#pragma once
// The points of a model in an order that its content decides, so that what samples them in order finds the same in a
// file whose rows were shuffled.
#include "ngs/stages/orbit/surface_points.h"

namespace ngs {

/// Usable Gaussians in the order of their positions: by z, then y, then x. Those of one position are ordered by opacity
/// and sizes, and where these are equal too, one is as good as the other.
std::vector<std::uint32_t> canonical_rows(const GaussianCloud& cloud);

/// surface_points() of the Gaussians with member[i] != 0 (empty: of all) in this order. Every k-th of them is a fair
/// sample.
orbit::SurfacePoints canonical_points(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member = {});

}  // namespace ngs
