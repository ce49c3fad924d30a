#pragma once
// What ngs cut works on, from its command line.
#include <set>
#include <string>
#include <vector>

#include "ngs/capture/mask_agreement.h"
#include "ngs/capture/scene_check.h"
#include "ngs/edit/fill/fill_options.h"
#include "ngs/options/field.h"
#include "ngs/orbit/orbit_options.h"
#include "ngs/problem/preset.h"
#include "shared/scene/import_options.h"

namespace ngs::ngs_tool {

/// A splat without photos, a capture, or a scene.json.
enum class SourceKind { kSplat, kCapture, kScene };

struct CutInputs {
  std::string source;  // as given on the command line
  SourceKind kind = SourceKind::kSplat;
  std::vector<std::string> strokes;       // prompt files and folders, as for ngs-mask --prompts
  std::string model, masks, truth;        // empty: from the capture
  std::string given_masks, given_truth;   // of these, as given on the command line
  std::string images, world_transform;    // of a capture; empty: from the capture, none
  std::vector<std::string> import_words;  // other options for ngs-scene import
  std::vector<std::string> all_words;     // all given options
  std::set<std::string> own_flags;        // of ngs cut
  std::string out;                        // the output folder
  bool trains_all = false;                // --all: a quality is given
  bool has_renders = false;               // all images are renders of the splat, or will be
  bool renders_capture = false;           // kSplat: `source` has the cameras of the renders, `model` is the splat
  std::string splat() const {             // with has_renders
    return kind == SourceKind::kSplat && !renders_capture ? source : model;
  }
};

/// Detects the kind: a folder, transforms.json, cameras.json or poses_bounds.npy is a capture, a JSON file with
/// "ngs_scene" a scene, everything else a splat, whose reader reports errors. Throws kBadInput if the path does not
/// exist.
SourceKind kind_of(const std::string& path);

/// The splat of a capture of which no photo is there and, unless the object is `marked` by strokes, no mask: pictures
/// can be rendered from its cameras. `model`: the splat as given, or empty. Empty: there are photos or masks, no splat,
/// or the capture is unreadable, which its import reports.
std::string splat_without_photos(const std::string& capture, const std::string& model, bool marked);

/// False for an empty path and for one that cannot be read.
bool exists(const std::string& path);

/// Throws kBadInput, with a list of the files found, if the capture has no splat.
void require_model_in(const std::string& path);

// The options of ngs cut.
enum class CutMethod { kNgs, kFlash };
inline constexpr NamedValue<CutMethod> kCutMethods[] = {{CutMethod::kNgs, "ngs"}, {CutMethod::kFlash, "flash"}};

struct CutOptions {
  CutMethod method = CutMethod::kNgs;
  Quality quality = Quality::kStandard;
  bool keep = false, all = false;
  bool all_pieces = false, force = false, finish = true;
  std::string hold_out;
  std::string view;
  std::string around, size, collider;
  UpAxis up = UpAxis::kAuto;
  double unit = 1;
  bool mesh = false;
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
    visit(self.all, Flag{"all",
                         "Cut out every object: by masks of everything in --masks, whose ids differ between the views, "
                         "else by the shape of the splat; labels are the closed form unless --quality is given"});
    visit(self.keep, Flag{"keep", "Keep intermediate files: boundary.ply and the training trace"});
    visit(self.all_pieces, Flag{"all_pieces", "Keep components of the object that no stroke touches"});
    visit(self.force, Flag{"force", "Train even if the result contradicts a stroke"});
    visit(self.finish, Flag{"finish", "Clip Gaussians of object.ply that reach out of its masks, as in ngs-extract"});
    visit(self.hold_out, Text{"hold_out", "every:N:K|FILE", "Views whose masks are used for scoring only"});
    visit(self.view, Text{"view", "NAME", "Picture that the strokes belong to; default: the name in each file"});
    visit(self.around,
          Text{"around", "X,Y,Z,R", "Splat: where the object is (centre, radius); default: the bulk of the splat"});
    visit(self.up, Choice<UpAxis>{"up",
                                  "Axis that points upwards: of a splat, as in ngs-scene orbit, and for --mesh "
                                  "and --format",
                                  kUpNames});
    visit(self.unit, Field<double>{"unit", "m", "Length of a unit of the model, for --mesh and --format", 1e-9, 1e9});
    visit(self.size, Text{"size", "WxH", "Splat: size of the renders in pixels; default: as ngs-scene orbit"});
    visit(self.view_count,
          Field<int>{"view_count", "", "Splat: number of pictures to make; 0: as many as needed", 0, 1000});
    visit(self.format,
          Text{"format", "EXT",
               "Also write object and background in this format, turned upright: compressed.ply, spz, sog, "
               "splat, glb or usda (repeatable)"});
    visit(self.mesh, Flag{"mesh", "Also write mesh.glb, a closed mesh of the object, with ngs-mesh"});
    visit(self.collider, Text{"collider", "KIND", "With --mesh: colliders in it: convex:N, hull or box"});
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
