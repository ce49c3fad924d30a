#pragma once
// The stages flags of ngs cut, from its input to the splat of the object.
//
//   OUT/orbit/       a splat: scene.json and images/, the pictures that strokes are made on
//   OUT/capture.json a capture: its cameras, photos and model
//   OUT/strokes/     masks from strokes, STEM.png
//   OUT/scene.json   the one that is cut: cameras, pictures and masks
//   OUT/labelled.ply object.ply background.ply masks/STEM.png agreement.json or metrics.json, report.html
//
// With --quality flash only orbit/, the models and masks/ (flash_cut.h).
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cut_options.h"
#include "cut_source.h"
#include "flash_cut.h"
#include "stage_runner.h"
#include "stroke_check.h"

namespace ngs::front {

struct CutInputs {
  std::string source;  // as given on the command line
  SourceKind kind = SourceKind::kSplat;
  std::vector<std::string> strokes;     // prompt files, as for ngs-mask --prompts
  std::string model, masks, truth;      // empty: from the capture
  std::string images, world_transform;  // of a capture; empty: from the capture, none
  Words import_words;                   // other options for ngs-scene import
  Words all_words;                      // all given options
  std::set<std::string> own_flags;      // of ngs cut
  std::string out;                      // the output folder
};

enum class CutEnd { kDone, kNeedsStrokes, kStopped };

class CutChain {
 public:
  CutChain(cli::Run& run, const CutOptions& options, CutInputs inputs);

  /// kNeedsStrokes: the images exist, but there is no stroke and no mask yet.
  CutEnd run();
  const StageRunner& stages() const { return stages_; }
  const CutInputs& inputs() const { return inputs_; }
  /// Figures of a finished --quality flash.
  const std::optional<FlashFigures>& flash() const { return flash_; }
  /// True if the untrained result was written because the trained one was worse.
  bool kept_untrained() const { return kept_untrained_; }
  /// Figures of the written result if it is untrained, else null.
  const FlashFigures* written_by_flash() const {
    return flash_ ? &*flash_ : kept_untrained_ ? &untrained_->figures : nullptr;
  }
  /// True if the images of an earlier run were reused.
  bool reused_orbit() const { return reused_orbit_; }
  std::string at(const std::string& name) const { return inputs_.out + "/" + name; }
  std::string pictures() const { return at("orbit/images"); }

 private:
  /// Calls StageRunner::run() and passes it the expected number of stages.
  bool stage(const std::string& name, const Words& words);
  bool make_scene();
  bool orbit();
  bool import();
  bool masks_from_strokes();
  void write_scene_with(const std::string& masks) const;
  bool cut_flash();
  std::optional<FlashCut> flash(const io::GaussianPly& ply, int longer_side_px);
  bool cut_untrained();
  bool check_strokes();
  bool cut();
  bool extract(const std::string& trained);
  void keep_better_result();
  bool score();

  cli::Run& run_;
  const CutOptions& options_;
  CutInputs inputs_;
  StageRunner stages_;
  std::string plain_scene_;  // scene file with cameras and images, before masks are added
  bool reused_orbit_ = false;
  std::optional<FlashFigures> flash_;
  std::optional<FlashCut> untrained_;  // for a splat without photos: result before training
  double untrained_wrong_ = 0;         // StrokeAgreement::wrong_share() of its labels
  bool kept_untrained_ = false;
};

}  // namespace ngs::front
