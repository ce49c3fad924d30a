#pragma once
// The options of ngs cut.
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
              "How long ngs-joint trains; flash: no training, labels from small renders of the ball (splats only)",
              kCutQualities});
    visit(self.keep, Flag{"keep", "Keep intermediate files: boundary.ply and the training trace"});
    visit(self.all_pieces, Flag{"all_pieces", "Keep components of the object that no stroke touches"});
    visit(self.force, Flag{"force", "Train even if the result contradicts a stroke"});
    visit(self.hold_out, Text{"hold_out", "every:N:K|FILE", "Views whose masks are used for scoring only"});
    visit(self.view, Text{"view", "NAME", "View on which the strokes were drawn; default: read from each file"});
    visit(self.around, Text{"around", "X,Y,Z,R", "Splat: ball that the cameras look at; default: its bulk"});
    visit(self.up, Text{"up", "AXIS", "Splat: axis that points upwards, as in ngs-scene orbit"});
    visit(self.size, Text{"size", "WxH", "Splat: size of the renders in pixels; default: as ngs-scene orbit"});
    visit(self.views, Field<int>{"views", "", "Splat: number of pictures to make; 0: as many as needed", 0, 1000});
    visit(self.image_scale, Field<double>{"image_scale", "",
                                          "Capture: working size relative to the photos; 0: 800 px at most", 0.0, 1.0});
  }
};

/// The options of ngs-scene import for a capture that CutOptions does not have.
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
