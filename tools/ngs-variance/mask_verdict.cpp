#include "mask_verdict.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/io/files/shell_word.h"

namespace ngs::variance {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGoOn = "; to go on with these masks: --min-mask-agreement -1";

std::string iou(double value) { return formatted("%.2f", value); }

/// The folder that holds all masks, and the ending of the first one.
struct MaskFiles {
  fs::path folder;
  std::string ending;
};

MaskFiles files_of(const Scene& scene) {
  MaskFiles files;
  for (const SceneView& view : scene.views) {
    if (view.mask_path.empty()) continue;
    const fs::path folder = fs::path(view.mask_path.substr(0, view.mask_path.find("{object}"))).parent_path();
    if (files.ending.empty()) files = {folder, fs::path(view.mask_path).extension().string()};
    while (!files.folder.empty() &&
           std::mismatch(files.folder.begin(), files.folder.end(), folder.begin(), folder.end()).first !=
               files.folder.end())
      files.folder = files.folder.parent_path();
  }
  return files;
}

[[noreturn]] void refuse_repairable(const Scene& scene, const RepairedAgreement& best) {
  const MaskFiles files = files_of(scene);
  const std::string folder = files.folder.empty() ? "." : files.folder.generic_string();
  const MaskRepair& repair = best.repair;
  std::string remedy = "name each mask after its photo";
  if (repair.shift != 0) remedy = "import the scene again with --mask-shift " + std::to_string(repair.shift);
  if (repair.inverted)
    remedy = "import the scene again " + std::string(scene.mask_invert ? "without" : "with") + " --mask-invert";
  if (repair.mogrify)
    remedy = "turn them with ImageMagick: find " + io::shell_word(folder) + " -name '*" + files.ending +
             "' -exec mogrify " + repair.mogrify + " {} +";
  throw Error(ErrorCode::kInconsistent,
              folder + ": the masks look " + repair.mistake + ", labels made from them match them with IoU " +
                  iou(best.before) + ", and with " + iou(best.after) +
                  " if that is undone, expected masks of their views",
              remedy + kGoOn);
}

[[noreturn]] void refuse_ids(const Scene& scene, const MaskAgreement& found) {
  constexpr std::size_t kNamed = 4;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, found.low.size()); ++i)
    names += (i > 0 ? ", " : "") + scene.objects[found.low[i]].name;
  if (found.low.size() > kNamed) names += " and " + std::to_string(found.low.size() - kNamed) + " more";
  throw Error(
      ErrorCode::kInconsistent,
      names + ": their masks contradict from view to view (IoU " + iou(found.alone) + " alone, " + iou(found.together) +
          " as one object), expected one id per object in all views",
      std::string("ids need tracking: make the masks with a tracker, such as SAM 2 on the photos as a video") + kGoOn);
}

}  // namespace

void check_masks(cli::Run& run, const MaskAgreementOptions& options, const EvidenceInputs& in) {
  if (options.min_mask_agreement < 0) return;
  const MaskAgreement found = measure_mask_agreement(run.exec(), run.monitor(), in);
  if (found.views == 0 || run.monitor().stop_requested()) return;
  Json& json = run.result()["mask_agreement"];
  json = {{"views", found.views}, {"given", found.given}};
  for (const RepairedAgreement& r : found.repaired)
    json["repaired"][r.repair.mistake] = {{"views", r.views}, {"before", r.before}, {"after", r.after}};
  if (!found.objects.empty()) json["objects"] = found.objects;
  if (!found.low.empty()) json["alone"] = found.alone, json["together"] = found.together;
  switch (found.verdict(options)) {
    case MaskVerdict::kFit: return;
    case MaskVerdict::kRepairable: refuse_repairable(in.scene, *found.mending());
    case MaskVerdict::kIdsContradict: refuse_ids(in.scene, found);
    case MaskVerdict::kContradict: break;
  }
  const bool is_low = found.given < options.min_mask_agreement;
  throw Error(ErrorCode::kInconsistent,
              "masks: labels made from them match them with IoU " + iou(found.given) + " in " +
                  std::to_string(found.views) + " views, expected " +
                  (is_low ? "at least " + iou(options.min_mask_agreement)
                          : "less with the masks of other views: they are " + found.best()->repair.mistake + " with " +
                                iou(found.best()->after)),
              std::string("see which masks are wrong: ngs-scene check SCENE --sheet masks.html") + kGoOn);
}

}  // namespace ngs::variance
