#pragma once
// The core of an object: its Gaussians with certain labels, and the distance from which others are separate.
#include <cstdint>
#include <span>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct CoreOptions {
  double share = 0.9;  // minimum share of object evidence
  // Minimum number of views, as a share of the largest number of views of any Gaussian with that share of evidence.
  // Gaussians that fewer views see may be background visible through the object.
  double seen = 0.25;
  double margin = 0.1;  // minimum distance of a separate Gaussian from the core, in RMS radii of the core,
  double spacings = 3;  // and in mean neighbour distances within the core
};

struct ObjectCore {
  std::vector<std::uint8_t> member;  // [N]
  double min_views = 0;              // minimum number of views of a member
  std::int64_t count = 0;
  double centre[3] = {}, radius = 0;  // mean position and RMS distance from it, world
};

/// The usable Gaussians of any of the objects that satisfy `share` and `seen`.
ObjectCore core_of(const CoreOptions& options, const GaussianCloud& cloud, std::span<const LabelColumns> objects);

/// Positions of the members, [count, 3].
std::vector<float> core_centres(const GaussianCloud& cloud, const ObjectCore& core);

/// The distance, world, below which the model does not separate the core from its surroundings.
double core_margin(const Exec& exec, const CoreOptions& options, const GaussianCloud& cloud, const ObjectCore& core);

}  // namespace ngs
