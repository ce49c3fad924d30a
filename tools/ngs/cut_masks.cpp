// CutChain: masks that do not fit, and scores of the result.
#include <algorithm>
#include <filesystem>

#include "cut_chain.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/io/scene/scene_json.h"

namespace ngs::ngs_tool {

namespace fs = std::filesystem;

/// Masks that no view has are meant for some: to mark the object by strokes instead would be a surprise.
void CutChain::refuse_unfit_masks() const {
  const nlohmann::json& report = stages_.report("ngs-scene");
  if (!report.is_object() || !report.at("result").contains("unfit_masks")) return;
  const nlohmann::json& unfit = report.at("result").at("unfit_masks");
  throw Error(ErrorCode::kInconsistent, unfit.at("found").get<std::string>(),
              unfit.at("remedy").get<std::string>() + "; or mark the object instead: --strokes FILE");
}

/// Masks of a capture that is cut by strokes. Photos whose alpha channel is a mask lack what it hides.
void CutChain::leave_masks_unused() {
  const Scene scene = io::read_scene_json(plain_scene_);
  if (std::ranges::all_of(scene.views, &std::string::empty, &SceneView::mask_path)) return;
  if (stages_.report("ngs-scene").at("result").at("mask_rules").contains(io::kAlphaRule))
    throw Error(ErrorCode::kInconsistent,
                inputs_.source + ": the alpha channel of the photos is a mask, expected opaque photos with strokes",
                "leave out --strokes to cut with this mask; or name a folder of opaque photos: --images DIR");
  run_.monitor().warn(inputs_.source + ": its masks are not used because strokes are given");
}

/// The closed form. Masks from strokes are checked by check_strokes().
bool CutChain::label() {
  Words words{"ngs-variance", at("scene.json"), "-o", at("boundary.ply")};
  const double least = inputs_.strokes.empty() ? options_.agreement.min_mask_agreement : -1;
  if (least != MaskAgreementOptions{}.min_mask_agreement)
    words.insert(words.end(), {"--min-mask-agreement", Json(least).dump()});
  return stage("ngs-variance", words);
}

/// True masks that were found, not given, need not be of this object: the result is then not scored. False: stopped by
/// a signal.
bool CutChain::score_by_truth() {
  constexpr double kOtherObject = 0.1;  // IoU
  const bool is_found = inputs_.given_truth.empty() && !inputs_.truth.empty();
  try {
    Words eval{"ngs-eval", at("masks"), at("scene.json"), "-o", at("metrics.json"), "--allow-empty"};
    const std::string views = options_.hold_out.empty() ? "all" : "held-out";
    if (!exists(at("objects"))) {  // one object
      if (!stage("ngs-render-alone", {"ngs-render", at("scene.json"), at("object.ply"), "--layers", "alpha", "--scale",
                                      "0", "--format", "png", "--views", views, "-o", at("alone")}))
        return false;
      eval.insert(eval.end(), {"--alone", at("alone")});
    }
    if (!stage("ngs-eval", eval)) return false;
    std::error_code ignored;
    if (!run_.dry_run()) fs::remove_all(at("alone"), ignored);
  } catch (const Error& e) {
    if (!is_found || e.code() == ErrorCode::kEnvironment) throw;
    not_scored_ = e.what();
    return true;
  }
  if (!is_found || run_.dry_run() || !exists(at("metrics.json"))) return true;
  const double iou = io::read_json_file(at("metrics.json")).at("mean").value("iou", 1.0);
  if (iou >= kOtherObject) return true;
  not_scored_ = inputs_.truth + " shows something else than the result (IoU " + formatted("%.3f", iou) + ")";
  fs::remove(at("metrics.json"));
  return true;
}

/// Scores the masks of the result against the true masks; without true masks, against the masks from strokes or the
/// input masks of held-out views.
bool CutChain::score() {
  const bool held_out = !options_.hold_out.empty();
  const std::string views = held_out ? "held-out" : "all";
  std::error_code ignored;
  if (!run_.dry_run()) fs::remove_all(at("masks"), ignored);
  if (!stage("ngs-render", {"ngs-render", at("scene.json"), at("labelled.ply"), "--layers", "mask", "--scale", "0",
                            "--format", "png", "--views", views, "-o", at("masks")}))
    return false;
  if (!run_.dry_run()) {
    for (const char* scores : {"metrics.json", "agreement.json"}) fs::remove(at(scores), ignored);
    agreement_ = compare_with_masks(io::read_scene_json(at("scene.json")), at("masks"));
  }
  if (inputs_.truth.empty() && !inputs_.strokes.empty()) {
    if (!stage("ngs-eval-agreement", {"ngs-eval", at("masks"), at("strokes"), "-o", at("agreement.json")}))
      return false;
  } else if (!inputs_.truth.empty() || held_out) {
    if (!score_by_truth()) return false;
  }
  return write_page();
}

}  // namespace ngs::ngs_tool
