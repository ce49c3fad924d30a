#pragma once
// The Gaussians of a region: within boxes and balls, above a plane, in clusters. In this order: a plane is looked for
// within the boxes and balls, and clusters are what is left of the object once the floor is gone.
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
  bool above_support = false;  // of the plane that find_support_plane() finds
  std::vector<orbit::Vec> cluster_at;
};

/// kUsage for what is no list of so many finite numbers, a box without corners apart, a ball without a radius, a plane
/// without a normal.
Region parse_region(const RegionOptions& options);

struct RegionSelection {
  std::vector<std::uint8_t> object;  // [N] 1: of the region; unusable Gaussians are not
  std::int64_t in_shapes = 0;        // after boxes and balls
  std::int64_t above_plane = 0;      // after the plane too
  SupportPlane plane;                // found: what auto has found, its offset without the model's origin
  std::int64_t clusters = 0;         // that there are to choose from; 0 where none were asked for
  double cluster_side = 0;           // world
};

/// Of the Gaussians with member[i] != 0. Depends on their set only, not on the order of rows. kNothingFound where no
/// plane is found for auto; an empty region is no error.
RegionSelection select_region(const Exec& exec, const RegionOptions& options, const GaussianCloud& cloud,
                              const std::vector<std::uint8_t>& member);

}  // namespace ngs
