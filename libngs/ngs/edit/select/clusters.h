#pragma once
// Clusters of Gaussians: connected components of occupied cells of a grid.
//
// A cell is occupied if it contains the centre of a solid Gaussian (opacity of at least 0.1). Occupied cells that share
// a face, an edge or a corner are in one cluster. Two solid Gaussians nearer than the side of a cell are therefore
// always connected, those farther than 2 √3 sides only through others. Haze does not connect objects: a Gaussian that
// is not solid belongs to the largest cluster in its own cell or an adjacent one.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs {

/// Gaussians of less opacity (0.1) connect nothing.
inline constexpr float kSolidLogit = -2.1972246f;

struct Clusters {
  std::vector<std::int32_t> of_row;  // [N] cluster; -1: none, or no member
  std::vector<std::int64_t> size;    // [clusters] Gaussians; ordered by solid Gaussians, most first, then by first cell
  double side = 0;                   // of a cell, world
};

/// Clusters the usable Gaussians with member[i] != 0; none if there are no members. `side` 0: cluster_side(). The
/// result depends on the set of Gaussians only, not on the order of their rows.
Clusters cluster_on_grid(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member,
                         double side = 0);

/// The side of a cell, world: four times the 90 % quantile of the distances between solid Gaussians and their nearest
/// solid neighbour. 0 with fewer than two, or if this quantile is 0.
double cluster_side(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member);
/// The same from the squared distances, at least one.
double side_of_spacings(const std::vector<float>& dist2);

// The points of a model in an order that depends on its content only, so that sampling every k-th point gives the same
// result for a file with shuffled rows.

/// Usable Gaussians ordered by z, then y, then x of their positions. Ties are ordered by opacity, then by scales.
std::vector<std::uint32_t> canonical_rows(const GaussianCloud& cloud);

/// surface_points() of the Gaussians with member[i] != 0 (all, if `member` is empty) in this order. Every k-th of them
/// is an unbiased sample.
orbit::SurfacePoints canonical_points(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member = {});

}  // namespace ngs
