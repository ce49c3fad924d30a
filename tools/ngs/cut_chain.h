#pragma once
// The stages flags of ngs cut, from its input to the splat of the object.
//
//   OUT/orbit/       a splat: scene.json and images/, the pictures that strokes are made on, and sheet.jpg, all of them
//   OUT/capture.json a capture: its cameras, photos and model
//   OUT/marked/      the marked views with their strokes
//   OUT/strokes/     masks from strokes, STEM.png
//   OUT/scene.json   the one that is cut: cameras, pictures and masks
//   OUT/groups/      --all: label maps with one id per object, their scene, and what is known of each object
//   OUT/labelled.ply object.ply background.ply masks/STEM.png agreement.json or metrics.json, report.html,
//                  object.html
//
// With --method flash only orbit/, marked/, the models, masks/ and the pages (flash_cut.h).
#include <optional>
#include <string>
#include <vector>

#include "cut_inputs.h"
#include "flash_cut.h"
#include "marked_views.h"
#include "ngs/edit/select/view_agreement.h"
#include "result_check.h"
#include "stage_runner.h"

namespace ngs::ngs_tool {

/// Throws kUsage if --all has no cameras or no masks of everything.
void check_all(const CutInputs& inputs);

enum class CutEnd { kDone, kNeedsStrokes, kStopped };

class CutChain {
 public:
  CutChain(cli::Run& run, const CutOptions& options, CutInputs inputs);

  /// kNeedsStrokes: the images exist, but there is no stroke and no mask yet.
  CutEnd run();
  const StageRunner& stages() const { return stages_; }
  const CutInputs& inputs() const { return inputs_; }
  bool cuts_all() const { return options_.all; }
  const std::vector<std::string>& formats() const { return options_.format; }
  /// Figures of a finished --method flash.
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
  /// Why true masks that were found with the capture were not used; empty: they were, or there are none.
  const std::string& not_scored() const { return not_scored_; }
  /// Of the written masks with the given ones, or with those from strokes.
  const ResultAgreement& agreement() const { return agreement_; }
  /// For a dry run: the marked views, one per line; empty without strokes.
  const std::string& strokes_found() const { return strokes_found_; }

 private:
  bool stage(const std::string& name, const Words& words) { return stages_.run(name, words); }
  void plan();
  bool make_scene();
  bool has_same_pictures(const Json& key) const;
  void look_at_strokes();
  bool orbit();
  bool import();
  void refuse_unfit_masks() const;
  bool masks_from_strokes();
  void write_scene_with(const std::string& masks) const;
  bool cut_flash();
  bool write_page();
  std::optional<FlashCut> flash(const io::GaussianPly& ply, int longer_side_px);
  void remove_results_of_training() const;
  bool cut_untrained();
  ResultQuality quality_of(const GaussianCloud& cloud, const std::vector<float>& label,
                           const std::vector<PixelMask>& masks) const;
  std::vector<PixelMask> masks_of_training() const;
  bool label();
  bool check_strokes();
  bool cut();
  bool extract(const std::string& trained);
  void keep_better_result();
  bool finish_untrained();
  bool score();
  bool score_by_truth();
  void leave_masks_unused();
  bool cut_all();
  void write_grouped_scene() const;

  cli::Run& run_;
  const CutOptions& options_;
  CutInputs inputs_;
  StageRunner stages_;
  std::string plain_scene_;  // scene file with cameras and images, before masks are added
  bool reused_orbit_ = false;
  bool imported_ = false;  // the capture
  std::optional<FlashFigures> flash_;
  ResultAgreement agreement_;
  std::string strokes_found_, not_scored_;
  std::optional<FlashCut> untrained_;  // for a splat without photos: result before training
  ResultQuality untrained_quality_;    // of its labels
  bool kept_untrained_ = false;
};

}  // namespace ngs::ngs_tool
