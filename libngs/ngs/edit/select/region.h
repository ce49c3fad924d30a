#pragma once
// Selects the Gaussians of a region: within boxes and balls, then above a plane, then in clusters. The plane is
// searched within the boxes and balls; clusters are formed after the floor is removed.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/edit/select/clusters.h"
#include "ngs/edit/select/support_plane.h"
#include "ngs/options/field.h"
#include "ngs/orbit/orbit_options.h"

namespace ngs {

struct RegionOptions {
  std::vector<std::string> keep_box = {};
  std::vector<std::string> keep_sphere = {};
  std::string drop_below_plane = {};
  UpAxis up = UpAxis::kAuto;
  std::vector<std::string> cluster_at = {};
  int largest = 0;
  double cluster_side = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.keep_box, Text{"keep_box", "X,Y,Z,X,Y,Z",
                              "The object lies in this box, given by two corners in model coordinates; several boxes "
                              "and spheres: in their union"});
    visit(self.keep_sphere, Text{"keep_sphere", "X,Y,Z,R", "The object lies in this ball"});
    visit(self.drop_below_plane, Text{"drop_below_plane", "auto|A,B,C,D",
                                      "The object lies where Ax + By + Cz + D > 0; auto: above the plane with most "
                                      "flat Gaussians, such as a floor or the top of a pedestal"});
    visit(self.up,
          Choice<UpAxis>{"up",
                         "Axis of the model that points upwards, for --drop-below-plane auto and to turn parts in "
                         "formats other than "
                         "PLY upright; auto: by the comment of a PLY (Vertical Axis), else away from a floor, else -y",
                         kUpNames});
    visit(self.cluster_at,
          Text{"cluster_at", "X,Y,Z", "Keep, of the remaining Gaussians, the cluster nearest to this point"});
    visit(self.largest,
          Field<int>{"largest", "clusters", "Number of largest remaining clusters to keep; 0: all", 0, 1 << 30});
    visit(self.cluster_side,
          Field<double>{"cluster_side", "world",
                        "Cell size for clustering; 0: four times the usual distance between neighbours", 0.0, 1e30});
  }

  bool any() const {
    return !keep_box.empty() || !keep_sphere.empty() || !drop_below_plane.empty() || !cluster_at.empty() || largest > 0;
  }
};

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
