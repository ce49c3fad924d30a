#pragma once
// The options of ngs-synth that override its recipe.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/options/field.h"

namespace ngs::cli {

/// kHalves: also the room without the target, and the target alone from all sides.
enum class Truth : std::uint8_t { kMasks, kHalves };

struct SynthOptions {
  int view_count = 0, width_px = 0, height_px = 0;
  std::int64_t scene_seed = -1;
  std::string target;
  std::vector<std::string> mask_noise;
  bool grey = false, cast_shadows = false, fit = true;
  Truth truth = Truth::kMasks;

  static constexpr NamedValue<Truth> kTruths[] = {{Truth::kMasks, "masks"}, {Truth::kHalves, "halves"}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.view_count, Field<int>{"view_count", "", "Number of cameras; 0: from the recipe", 0, 10000});
    visit(self.width_px, Field<int>{"width_px", "px", "Image width; 0: from the recipe", 0, 16384});
    visit(self.height_px, Field<int>{"height_px", "px", "Image height; 0: from the recipe", 0, 16384});
    visit(self.scene_seed,
          Field<std::int64_t>{"scene_seed", "", "Seed of textures and layout; -1: from the recipe", -1, 1ll << 53});
    visit(self.target, Text{"target", "NAME", "Object whose masks go to masks/; default: from the recipe"});
    visit(self.mask_noise,
          Text{"mask_noise", "KIND:AMOUNT",
               "Errors to add to masks/ and labels/: erode:PX dilate:PX jitter:PX snap:PX drop:P swap:P blob:P"});
    visit(self.grey, Flag{"grey", "Make all images grey; off: from the recipe"});
    visit(self.cast_shadows, Flag{"cast_shadows", "Let the objects cast shadows; off: from the recipe"});
    visit(self.truth, Choice<Truth>{"truth",
                                    "Ground truth to write; halves: also the room without the target, and the target "
                                    "alone from all sides, to halves/",
                                    kTruths});
    visit(self.fit, Flag{"fit", "Fit a splat to the photos and write point_cloud.ply"});
  }
};

}  // namespace ngs::cli
