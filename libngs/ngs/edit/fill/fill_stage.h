#pragma once
// Fills the hole that a removed object leaves in the background. Finds the surfaces at the rim of the hole, removes
// debris of the object, and covers the hole with flat Gaussians that continue the texture of these surfaces. The result
// is plausible but invented: no view shows the place. No neural network is used.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/edit/fill/cast_shadow.h"
#include "ngs/edit/fill/fill_options.h"
#include "ngs/edit/fill/fill_texture.h"
#include "ngs/math/vec.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

struct FilledSurface {
  bool is_plane = true;
  Vec3<double> normal{0, 0, 1};  // of the plane, or of the plane below a curved surface; towards the object
  std::int64_t rim_points = 0;   // solid background Gaussians on the surface near the object
  double residual = 0;           // median distance of these Gaussians from the surface, world
  double spacing = 0;            // usual distance between neighbouring Gaussians of the surface, world
  double cell_side = 0;          // world
  std::int64_t cells = 0;        // cells of the hole
  std::int64_t one_sided = 0;    // cells left out, because the rim is missing on one side
  std::int64_t continued = 0;    // cells left out, because the surface continues below the object
  Footprint footprint;           // of the object on the surface
  CastShadow shadow;             // of the object
  TextureFill texture = TextureFill::kNothing;
  std::int64_t rows = 0;  // Gaussians added
};

struct HoleFill {
  std::vector<FilledSurface> surfaces;
  std::vector<std::uint8_t> removed;              // [N] 1: a row of the background to be left out
  std::int64_t removed_rows = 0, relit_rows = 0;  // counts; a relit row is replaced by a copy in `filled`
  GaussianCloud filled;  // the added Gaussians, then the relit ones, with the origin and the degree of the model
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
