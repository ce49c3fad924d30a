#pragma once
// Selects the Gaussians of a region: within boxes and balls, then above a plane, then in clusters. The plane is
// searched within the boxes and balls; clusters are formed after the floor is removed.
#include <array>
#include <optional>

#include "ngs/backend/exec.h"
#include "ngs/stages/select/clusters.h"
#include "ngs/stages/select/region_options.h"
#include "ngs/stages/select/support_plane.h"

namespace ngs {

/// Positions are world, the model's origin included.
struct Region {
  struct Box {
    orbit::Vec low, high;
  };
  struct HalfSpace {
    orbit::Vec normal;
    double offset = 0;  // inside: normal · p + offset > 0
  };
  std::vector<Box> boxes;
  std::vector<orbit::Ball> balls;
  std::optional<HalfSpace> above;
  bool above_support = false;  // above the plane of find_support_plane()
  std::vector<orbit::Vec> cluster_at;
};

/// Throws kUsage for a wrong count of numbers, a non-finite number, a box without volume, a ball without a radius, or a
/// plane without a normal.
Region parse_region(const RegionOptions& options);

struct RegionSelection {
  std::vector<std::uint8_t> object;  // [N] 1: in the region; 0 for unusable Gaussians
  std::int64_t in_shapes = 0;        // Gaussians after boxes and balls
  std::int64_t above_plane = 0;      // Gaussians after the plane
  SupportPlane plane;                // the plane of auto, offset relative to the model's origin; else found is false
  std::int64_t clusters = 0;         // number of clusters; 0 if none are selected by
  double cluster_side = 0;           // world
};

/// Selects among the Gaussians with member[i] != 0. Depends on their set only, not on the order of rows. Throws
/// kNothingFound if auto finds no plane; an empty region is no error.
RegionSelection select_region(const Exec& exec, const RegionOptions& options, const GaussianCloud& cloud,
                              const std::vector<std::uint8_t>& member);

}  // namespace ngs
