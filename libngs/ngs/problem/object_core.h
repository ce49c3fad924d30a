#pragma once
// The object without its rim: the Gaussians of which there is no doubt, and how far from them something is apart.
#include <cstdint>
#include <span>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/problem/problem.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct CoreOptions {
  double share = 0.9;  // least share of object evidence
  double seen = 0.25;  // by at least this share of the views that the best seen Gaussian of that share has: what fewer
                       // see may be a trace; not of all Gaussians, of which some are seen where no view sees the object
  double margin = 0.1;  // what is apart, in RMS radii of the core
  double spacings = 3;  // and at least this many times the distance of neighbours in the core
};

struct ObjectCore {
  std::vector<std::uint8_t> member;  // [N]
  double least_views = 0;            // of a member
  std::int64_t count = 0;
  double centre[3] = {}, radius = 0;  // mean and RMS distance from it, world
};

/// Usable Gaussians of any of the objects whose share is large and which enough views see.
ObjectCore core_of(const CoreOptions& options, const GaussianCloud& cloud, std::span<const LabelColumns> objects);

/// Positions of the members, [count, 3].
std::vector<float> core_centres(const GaussianCloud& cloud, const ObjectCore& core);

/// Nearer than this, world, the model does not tell the core from what surrounds it.
double core_margin(const Exec& exec, const CoreOptions& options, const GaussianCloud& cloud, const ObjectCore& core);

}  // namespace ngs
