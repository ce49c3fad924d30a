#pragma once
// The stages of ngs cut, from what it is given to the object's own splat.
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
  std::string source;  // as it was given
  SourceKind kind = SourceKind::kSplat;
  std::vector<std::string> strokes;     // files for ngs-mask --prompts
  std::string model, masks, truth;      // empty: what the capture has
  std::string images, world_transform;  // of a capture; empty: as above, none
  Words import_words;                   // further options of ngs-scene import
  Words all_words;                      // all options that were given
  std::set<std::string> own_flags;      // of ngs cut
  std::string out;                      // the folder
};

enum class CutEnd { kDone, kNeedsStrokes, kStopped };

class CutChain {
 public:
  CutChain(cli::Run& run, const CutOptions& options, CutInputs inputs);

  /// kNeedsStrokes: the pictures are made, and there is neither a stroke nor a mask yet.
  CutEnd run();
  const StageRunner& stages() const { return stages_; }
  const CutInputs& inputs() const { return inputs_; }
  /// Of --quality flash, after it.
  const std::optional<FlashFigures>& flash() const { return flash_; }
  /// The trained result was worse than what was known before, which was written in its place.
  bool kept_first() const { return kept_first_; }
  /// Of what was written, where it was not trained; else null.
  const FlashFigures* written_by_flash() const { return flash_ ? &*flash_ : kept_first_ ? &first_->figures : nullptr; }
  /// The pictures were those of an earlier run.
  bool reused_orbit() const { return reused_orbit_; }
  std::string at(const std::string& name) const { return inputs_.out + "/" + name; }
  std::string pictures() const { return at("orbit/images"); }

 private:
  /// StageRunner::run(), which is told how many there will be.
  bool stage(const std::string& name, const Words& words);
  bool make_scene();
  bool orbit();
  bool import();
  bool masks_from_strokes();
  void write_scene_with(const std::string& masks) const;
  bool cut_flash();
  std::optional<FlashCut> flash(const io::GaussianPly& ply, int longer_side_px);
  bool look_first();
  bool strokes_hold();
  bool cut();
  bool extract(const std::string& trained);
  void keep_the_better();
  bool score();

  cli::Run& run_;
  const CutOptions& options_;
  CutInputs inputs_;
  StageRunner stages_;
  std::string plain_scene_;  // cameras and pictures, before masks of ours are laid to it
  bool reused_orbit_ = false;
  std::optional<FlashFigures> flash_;
  std::optional<FlashCut> first_;  // of a splat alone, before anything is trained
  double first_wrong_ = 0;         // StrokeAgreement::wrong_share() of its labels
  bool kept_first_ = false;
};

}  // namespace ngs::front
