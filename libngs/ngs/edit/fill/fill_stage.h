#pragma once
// Fills the hole that a removed object leaves in the background: finds the surfaces at its rim, removes what existed
// only because of the object, and lays Gaussians over what no Gaussian covers, with colours from the surroundings. The
// result is invented: it agrees with the rim, not with the place. No network is used.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/edit/fill/fill_options.h"
#include "ngs/edit/fill/fill_texture.h"
#include "ngs/math/vec.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct FilledSurface {
  bool is_plane = true;
  Vec3<double> normal{0, 0, 1};  // of the plane, or of the plane below a curved surface; towards the object
  std::int64_t rim_points = 0;   // solid Gaussians of the background in it, near the object
  double residual = 0;           // their median distance, world
  double spacing = 0;            // their usual distance from each other, world
  double cell_side = 0;          // world
  std::int64_t cells = 0;        // cells of the hole
  std::int64_t one_sided = 0;    // cells left out, because the rim is missing on one side
  std::int64_t continued = 0;    // cells left out, because the surface continues below the object
  TextureFill texture = TextureFill::kNothing;
  std::int64_t rows = 0;  // Gaussians added
};

struct HoleFill {
  std::vector<FilledSurface> surfaces;
  std::vector<std::uint8_t> removed;  // [N] 1: a row of the background to be left out
  std::int64_t removed_rows = 0;
  GaussianCloud filled;  // the added Gaussians, with the origin and the degree of the model
  std::string nothing;   // why nothing is filled, one clause; empty if something is
};

struct FillInput {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& object;  // [N] 1: removed
};

/// Nothing is filled and removed if the object has no rendered Gaussian, or if its rim has no surface with a hole. The
/// same bytes for any number of threads.
HoleFill fill_hole(const Exec& exec, Monitor& monitor, const FillOptions& options, const FillInput& input,
                   std::uint64_t seed);

}  // namespace ngs
