#pragma once
// What of a whole scene is taken out as debris, and from which size.
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
    visit(self.min_opacity, Field<double>{"min_opacity", "",
                                          "near-transparent: less opaque than this, the least that training keeps; 0: "
                                          "none is",
                                          0.0, 1.0});
    visit(self.max_size, Field<double>{"max_size", "",
                                       "oversized: the largest standard deviation is more than this share of the "
                                       "distance from the middle of the scene, or of the radius of its bulk within "
                                       "it; 0: none is",
                                       0.0, 1e9});
    visit(self.max_needle, Field<double>{"max_needle", "",
                                         "needle: the largest standard deviation is more than this many times the "
                                         "middle one; 0: none is",
                                         0.0, 1e9});
    visit(self.isolation, Field<double>{"isolation", "",
                                        "isolated or a floater: farther from the others than this many times what is "
                                        "usual there; 0: none is",
                                        0.0, 1e9});
    visit(self.floater_size,
          Field<int>{"floater_size", "Gaussians", "floaters: pieces apart of at most so many; 0: none is", 0, 1 << 30});
  }
};

}  // namespace ngs
