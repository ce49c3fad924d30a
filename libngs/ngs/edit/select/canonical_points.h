#pragma once
// The points of a model in an order that depends on its content only, so that sampling every k-th point gives the same
// result for a file with shuffled rows.
#include "ngs/scene/geometry/surface_points.h"

namespace ngs {

/// Usable Gaussians ordered by z, then y, then x of their positions. Ties are ordered by opacity, then by scales.
std::vector<std::uint32_t> canonical_rows(const GaussianCloud& cloud);

/// surface_points() of the Gaussians with member[i] != 0 (all, if `member` is empty) in this order. Every k-th of them
/// is an unbiased sample.
orbit::SurfacePoints canonical_points(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member = {});

}  // namespace ngs
