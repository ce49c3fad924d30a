// CutChain: masks that do not fit, groups of masks of everything, and scores of the result.
#include <algorithm>
#include <filesystem>

#include "cut_chain.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/io/scene/scene_json.h"
#include "objects_page.h"

namespace ngs::ngs_tool {

namespace fs = std::filesystem;

/// Throws if given masks match no view: a silent fallback to strokes would surprise the user.
void CutChain::refuse_unfit_masks() const {
  const nlohmann::json& report = stages_.report("ngs-scene");
  if (!report.is_object() || !report.at("result").contains("unfit_masks")) return;
  const nlohmann::json& unfit = report.at("result").at("unfit_masks");
  throw Error(ErrorCode::kInconsistent, unfit.at("found").get<std::string>(),
              unfit.at("remedy").get<std::string>() + "; or mark the object instead: --strokes FILE");
}

/// Warns that strokes replace the masks. Throws if these are alpha channels of the photos, which hide parts of them.
void CutChain::leave_masks_unused() {
  const Scene scene = io::read_scene_json(plain_scene());
  if (std::ranges::all_of(scene.views, &std::string::empty, &SceneView::mask_path)) return;
  if (stages_.report("ngs-scene").at("result").at("mask_rules").contains(io::kAlphaRule))
    throw Error(ErrorCode::kInconsistent,
                inputs_.source + ": the alpha channel of the photos is a mask, expected opaque photos with strokes",
                "leave out --strokes to cut with this mask; or name a folder of opaque photos: --images DIR");
  run_.monitor().warn(inputs_.source + ": its masks are not used because strokes are given");
}

/// Runs a scoring step. True masks that were found, not given, may show another object: then nothing is scored. False:
/// stopped by a signal.
bool CutChain::score_by_truth(const PlannedStep& step) {
  constexpr double kOtherObject = 0.1;  // IoU
  if (!not_scored_.empty() || (step.name == "ngs-render-alone" && !*facts_.one_object)) return true;
  const bool is_found = inputs_.given_truth.empty() && !inputs_.truth.empty();
  try {
    if (!stages_.run(step)) return false;
  } catch (const Error& e) {
    if (!is_found || e.code() == ErrorCode::kEnvironment) throw;
    not_scored_ = e.what();
    return true;
  }
  if (step.name != "ngs-eval") return true;
  std::error_code absent;
  fs::remove_all(at("alone"), absent);
  if (!is_found || !exists(at("metrics.json"))) return true;
  const double iou = io::read_json_file(at("metrics.json")).at("mean").value("iou", 1.0);
  if (iou >= kOtherObject) return true;
  not_scored_ = inputs_.truth + " shows something else than the result (IoU " + formatted("%.3f", iou) + ")";
  fs::remove(at("metrics.json"));
  return true;
}

/// The scene of ngs-group as OUT/scene.json.
void CutChain::take_groups() {
  const std::string grouped = at("groups/scene.json");
  const Scene scene = io::read_scene_json(grouped);
  io::write_scene_json(at("scene.json"), scene, io::StoredPaths::kRelative, io::truth_of_scene_json(grouped));
  fs::copy_file(at("groups/objects.json"), at("objects.json"), fs::copy_options::overwrite_existing);
  facts_.one_object = scene.objects.size() == 1;
  plan();
}

void CutChain::write_objects_page() {
  io::write_file(at("report.html"), objects_page(io::read_scene_json(at("scene.json")),
                                                 Json(io::read_json_file(at("objects.json"))), at("masks")));
}

}  // namespace ngs::ngs_tool
