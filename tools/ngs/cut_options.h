#pragma once
// The options of ngs cut.
#include <string>
#include <vector>

#include "ngs/capture/mask_agreement.h"
#include "ngs/capture/scene_check.h"
#include "ngs/edit/fill/fill_options.h"
#include "ngs/options/field.h"
#include "ngs/problem/preset.h"
#include "shared/scene/import_options.h"

namespace ngs::ngs_tool {

enum class CutMethod { kNgs, kFlash };
inline constexpr NamedValue<CutMethod> kCutMethods[] = {{CutMethod::kNgs, "ngs"}, {CutMethod::kFlash, "flash"}};

struct CutOptions {
  CutMethod method = CutMethod::kNgs;
  Quality quality = Quality::kStandard;
  bool keep = false;
  bool all_pieces = false, force = false, finish = true;
  std::string hold_out;
  std::string view;
  std::string around, up = "auto", size;
  std::vector<std::string> format;
  int view_count = 0;
  double image_scale = 0;
  FillOptions fill;
  MaskAgreementOptions agreement;

  /// Whether ngs-extract changes the halves beyond the choice of their Gaussians.
  bool mends_halves() const { return finish || fill.fill != FillKind::kOff; }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.method,
          Choice<CutMethod>{"method", "ngs: train with ngs-joint; flash: labels in seconds, splats only", kCutMethods});
    visit(self.quality, Choice<Quality>{"quality", "How long ngs-joint trains", kQualityNames});
    visit(self.keep, Flag{"keep", "Keep intermediate files: boundary.ply and the training trace"});
    visit(self.all_pieces, Flag{"all_pieces", "Keep components of the object that no stroke touches"});
    visit(self.force, Flag{"force", "Train even if the result contradicts a stroke"});
    visit(self.finish, Flag{"finish", "Clip Gaussians of object.ply that reach out of its masks, as in ngs-extract"});
    visit(self.hold_out, Text{"hold_out", "every:N:K|FILE", "Views whose masks are used for scoring only"});
    visit(self.view, Text{"view", "NAME", "Picture that the strokes belong to; default: the name in each file"});
    visit(self.around,
          Text{"around", "X,Y,Z,R", "Splat: where the object is (centre, radius); default: the bulk of the splat"});
    visit(self.up, Text{"up", "AXIS", "Splat: axis that points upwards, as in ngs-scene orbit"});
    visit(self.size, Text{"size", "WxH", "Splat: size of the renders in pixels; default: as ngs-scene orbit"});
    visit(self.view_count,
          Field<int>{"view_count", "", "Splat: number of pictures to make; 0: as many as needed", 0, 1000});
    visit(self.format,
          Text{"format", "EXT",
               "Also write object and background in this format, turned upright: compressed.ply, spz, sog, "
               "splat, glb or usda (repeatable)"});
    visit(self.image_scale, Field<double>{"image_scale", "",
                                          "Capture: working size relative to the photos; 0: 800 px at most", 0.0, 1.0});
    FillOptions::describe(self.fill, visit);
    MaskAgreementOptions::describe(self.agreement, visit);
  }
};

/// The options of ngs-scene import for a capture that CutOptions does not have.
struct CaptureOptions {
  cli::ImportOptions import;
  SceneCheckOptions checks;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    cli::ImportOptions::describe(self.import, [&](auto& value, const auto& field) {
      if (field.name != "hold_out" && field.name != "image_scale") visit(value, field);
    });
    SceneCheckOptions::describe(self.checks, visit);
  }
};

}  // namespace ngs::ngs_tool
