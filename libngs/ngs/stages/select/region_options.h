#pragma once
// Selection of an object by its position alone, without labels or photos.
#include <string>
#include <vector>

#include "ngs/options/field.h"
#include "ngs/stages/orbit/orbit_options.h"

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
          Choice<UpAxis>{
              "up",
              "Axis of the model that points upwards, for --drop-below-plane auto; auto: away from a floor, else -y",
              kUpNames});
    visit(self.cluster_at,
          Text{"cluster_at", "X,Y,Z", "Keep, of the remaining Gaussians, the cluster nearest to this point"});
    visit(self.largest,
          Field<int>{"largest", "clusters", "Number of largest remaining clusters to keep; 0: all", 0, 1 << 30});
    visit(self.cluster_side,
          Field<double>{"cluster_side", "world",
                        "Cell size for clustering; 0: four times the usual distance between neighbours", 0.0, 1e30});
  }

  /// Whether any option selects a region.
  bool any() const {
    return !keep_box.empty() || !keep_sphere.empty() || !drop_below_plane.empty() || !cluster_at.empty() || largest > 0;
  }
};

}  // namespace ngs
