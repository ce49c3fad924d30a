#pragma once
// Runs the steps of cut_plan.h, and what happens in this process around them.
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

enum class CutEnd { kDone, kNeedsStrokes, kStopped };

class CutChain {
 public:
  CutChain(cli::Run& run, const CutOptions& options, CutInputs inputs);

  /// kNeedsStrokes: the images exist, but there is no stroke and no mask yet.
  CutEnd run();
  const StageRunner& stages() const { return stages_; }
  const CutInputs& inputs() const { return inputs_; }
  bool writes_mesh() const { return options_.mesh; }
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
  bool reused_orbit() const { return facts_.reuses_pictures; }
  std::string at(const std::string& name) const { return inputs_.out + "/" + name; }
  std::string pictures() const { return at("orbit/images"); }
  std::string plain_scene() const { return ngs_tool::plain_scene(options_, inputs_); }
  /// Why true masks that were found with the capture were not used; empty: they were, or there are none.
  const std::string& not_scored() const { return not_scored_; }
  /// Agreement of the written masks with the given masks, or with the masks from strokes.
  const ResultAgreement& agreement() const { return agreement_; }
  /// For a dry run: the marked views, one per line; empty without strokes.
  const std::string& strokes_found() const { return strokes_found_; }

 private:
  bool marked() const { return !inputs_.strokes.empty(); }
  void plan();
  bool needs_strokes() const;
  // Each step of the plan: what precedes its command, and what follows it. False: stopped by a signal.
  bool run_step(const PlannedStep& step);
  void before(const std::string& step);
  bool after(const std::string& step);
  void take_pictures_of_earlier_run();
  bool has_same_pictures() const;
  void take_capture();
  void refuse_unfit_masks() const;
  void write_scene(const std::string& from, const std::string& to, const std::string& masks) const;
  bool cut_flash();
  std::optional<FlashCut> flash(const io::GaussianPly& ply, int longer_side_px);
  void remove_results_of_training() const;
  bool cut_untrained();
  ResultQuality quality_of(const GaussianCloud& cloud, const std::vector<float>& label,
                           const std::vector<PixelMask>& masks) const;
  std::vector<PixelMask> masks_of_training() const;
  bool check_strokes();
  bool keep_better_result();
  bool score_by_truth(const PlannedStep& step);
  void leave_masks_unused();
  void take_groups();
  void write_objects_page();

  cli::Run& run_;
  const CutOptions& options_;
  CutInputs inputs_;
  StageRunner stages_;
  PlanFacts facts_;
  Json pictures_of_;       // what pictures of a splat are made from
  bool imported_ = false;  // the capture
  std::optional<FlashFigures> flash_;
  ResultAgreement agreement_;
  std::string strokes_found_, not_scored_;
  std::optional<FlashCut> untrained_;  // for a splat without photos: result before training
  ResultQuality untrained_quality_;    // of its labels
  bool kept_untrained_ = false;
};

}  // namespace ngs::ngs_tool
