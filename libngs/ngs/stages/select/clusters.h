#pragma once
// Clusters of Gaussians: what hangs together on a grid of occupied cells.
//
// A cell is occupied where a solid Gaussian (opacity from 0.1) has its centre in it. Occupied cells that touch, by a
// side, an edge or a corner, are of one cluster: solid Gaussians nearer than the side of a cell always are, those
// farther than 2 √3 sides never without others between them. Haze between two objects does not join them: a Gaussian
// that is not solid belongs to the largest cluster in its own cell or one that touches it.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct Clusters {
  std::vector<std::int32_t> of_row;  // [N] -1: of none, or no member
  std::vector<std::int64_t>
      size;         // [clusters] Gaussians; those of most solid ones come first, then by their first cell
  double side = 0;  // world, of a cell
};

/// Of the usable Gaussians with member[i] != 0. `side` 0: cluster_side(). Depends on the set of Gaussians only, not on
/// the order of their rows. No member: no cluster.
Clusters cluster_on_grid(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member,
                         double side = 0);

/// The side of a cell, world: four times the distance to the nearest other solid Gaussian that nine in ten do not
/// exceed. 0 where there are fewer than two, or nine in ten lie on another.
double cluster_side(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member);

}  // namespace ngs
