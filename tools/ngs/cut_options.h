#pragma once
// What ngs cut can be told.
#include <string>

#include "ngs/options/field.h"
#include "ngs/stages/scene/scene_check.h"
#include "shared/scene/import_options.h"

namespace ngs::front {

enum class CutQuality { kFlash, kDraft, kStandard, kHigh, kReference };
inline constexpr NamedValue<CutQuality> kCutQualities[] = {{CutQuality::kFlash, "flash"},
                                                           {CutQuality::kDraft, "draft"},
                                                           {CutQuality::kStandard, "standard"},
                                                           {CutQuality::kHigh, "high"},
                                                           {CutQuality::kReference, "reference"}};

struct CutOptions {
  CutQuality quality = CutQuality::kStandard;
  bool keep = false;
  bool all_pieces = false, force = false;
  std::string hold_out;
  std::string view;
  std::string around, up = "auto", size;
  int views = 0;
  double image_scale = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.quality,
          Choice<CutQuality>{
              "quality",
              "of ngs-joint: how long to train; flash: not at all, labels of a splat alone from small pictures "
              "of the ball",
              kCutQualities});
    visit(self.keep, Flag{"keep", "leave what is made on the way: boundary.ply and the trace of the training"});
    visit(self.all_pieces, Flag{"all_pieces", "keep the pieces of the object that no stroke touches"});
    visit(self.force, Flag{"force", "train although the result disagrees with a stroke"});
    visit(self.hold_out, Text{"hold_out", "every:N:K|FILE", "views whose masks no stage sees; they are scored"});
    visit(self.view, Text{"view", "NAME", "the view that the strokes are of; default: as each says"});
    visit(self.around, Text{"around", "X,Y,Z,R", "a splat: the ball that the cameras look at; default: its bulk"});
    visit(self.up, Text{"up", "AXIS", "a splat: as ngs-scene orbit takes it"});
    visit(self.size, Text{"size", "WxH", "a splat: pixels of the pictures; default: as ngs-scene orbit"});
    visit(self.views, Field<int>{"views", "", "a splat: pictures to begin with; 0: as ngs-scene orbit", 0, 10000});
    visit(self.image_scale,
          Field<double>{"image_scale", "", "a capture: working size over the photos'; 0: 800 px at most", 0.0, 1.0});
  }
};

/// What ngs-scene import is told of a capture, beside what CutOptions says of it.
struct CaptureOptions {
  capture::ImportOptions import;
  SceneCheckOptions checks;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    capture::ImportOptions::describe(self.import, [&](auto& value, const auto& field) {
      if (field.name != "hold_out" && field.name != "image_scale") visit(value, field);
    });
    SceneCheckOptions::describe(self.checks, visit);
  }
};

}  // namespace ngs::front
