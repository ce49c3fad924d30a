#pragma once
// Thresholds for debris that is removed from a full scene.
#include "ngs/options/field.h"

namespace ngs {

struct CleanOptions {
  double min_opacity = 0.005;
  double max_size = 0.3;
  double max_needle = 100;
  double isolation = 10;
  int floater_size = 200;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.min_opacity,
          Field<double>{"min_opacity", "",
                        "Near-transparent: opacity below this, the lowest that training keeps; 0: off", 0.0, 1.0});
    visit(self.max_size, Field<double>{"max_size", "",
                                       "Oversized: largest standard deviation above this fraction of the distance from "
                                       "the scene centre (inside the bulk of the scene: of its radius); 0: off",
                                       0.0, 1e9});
    visit(self.max_needle,
          Field<double>{"max_needle", "",
                        "Needle: largest standard deviation above this multiple of the middle one; 0: off", 0.0, 1e9});
    visit(self.isolation,
          Field<double>{
              "isolation", "",
              "Isolated or floater: distance to the others above this multiple of the usual local distance; 0: off",
              0.0, 1e9});
    visit(self.floater_size, Field<int>{"floater_size", "Gaussians",
                                        "Floaters: separate components of at most this many; 0: off", 0, 1 << 30});
  }
};

}  // namespace ngs
