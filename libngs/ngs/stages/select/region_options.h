#pragma once
// What of a model is the object, said by where it is: no labels, no photos.
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
                              "the object lies between these two corners, in the model's own coordinates; repeatable: "
                              "in any of the boxes and spheres"});
    visit(self.keep_sphere, Text{"keep_sphere", "X,Y,Z,R", "the object lies in this ball; repeatable"});
    visit(self.drop_below_plane,
          Text{"drop_below_plane", "auto|A,B,C,D",
               "the object lies where Ax + By + Cz + D > 0; auto: above the plane that most of what lies flat is in, "
               "such as a floor or the top of a pedestal"});
    visit(self.up, Choice<UpAxis>{"up",
                                  "axis of the model that points upwards, for --drop-below-plane auto; auto: away from "
                                  "a floor, else -y",
                                  kUpNames});
    visit(self.cluster_at, Text{"cluster_at", "X,Y,Z",
                                "of what is left, the cluster of the Gaussian nearest to this point; repeatable"});
    visit(self.largest, Field<int>{"largest", "clusters", "of what is left, the largest clusters; 0: all", 0, 1 << 30});
    visit(self.cluster_side,
          Field<double>{"cluster_side", "world",
                        "side of the cells of which a cluster is made; 0: four times the usual distance of neighbours",
                        0.0, 1e30});
  }

  /// Whether anything is asked for.
  bool any() const {
    return !keep_box.empty() || !keep_sphere.empty() || !drop_below_plane.empty() || !cluster_at.empty() || largest > 0;
  }
};

}  // namespace ngs
