#pragma once
// What ngs-synth takes beside its recipe.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/options/field.h"

namespace ngs::cli {

struct SynthOptions {
  int views = 0, width_px = 0, height_px = 0;
  std::int64_t scene_seed = -1;
  std::string target;
  std::vector<std::string> mask_noise;
  bool grey = false, fit = true;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.views, Field<int>{"views", "", "number of cameras; 0: as the recipe says", 0, 10000});
    visit(self.width_px, Field<int>{"width_px", "px", "image width; 0: as the recipe says", 0, 16384});
    visit(self.height_px, Field<int>{"height_px", "px", "image height; 0: as the recipe says", 0, 16384});
    visit(self.scene_seed,
          Field<std::int64_t>{"scene_seed", "", "textures and layout; -1: as the recipe says", -1, 1ll << 53});
    visit(self.target, Text{"target", "NAME", "object that masks/ shows; default: as the recipe says"});
    visit(self.mask_noise, Text{"mask_noise", "KIND:AMOUNT",
                                "errors in masks/ and labels/: erode:PX dilate:PX jitter:PX snap:PX drop:P "
                                "swap:P blob:P"});
    visit(self.grey, Flag{"grey", "take the colours away; off: as the recipe says"});
    visit(self.fit, Flag{"fit", "write point_cloud.ply, fitted to the photos"});
  }
};

}  // namespace ngs::cli
