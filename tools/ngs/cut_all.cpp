// CutChain: every object of masks of everything.
#include <filesystem>

#include "cut_chain.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/options/name_of.h"
#include "objects_page.h"

namespace ngs::ngs_tool {

namespace fs = std::filesystem;

namespace {

void refuse(const std::string& what, const std::string& remedy) { throw Error(ErrorCode::kUsage, what, remedy); }

}  // namespace

void check_all(const CutInputs& inputs) {
  const std::string remedy =
      "let an automatic segmenter write id maps of all photos, one per view and named like it, and give their folder: "
      "--masks DIR";
  if (!inputs.strokes.empty())
    refuse("--all with --strokes: strokes mark one object, expected masks of everything", remedy);
  if (inputs.kind == SourceKind::kSplat)
    refuse(inputs.source + ": --all with a splat alone, expected cameras and masks of everything",
           "make pictures of it and a scene with ngs-scene orbit; then " + remedy);
  const bool has_masks = !inputs.masks.empty() || (inputs.kind == SourceKind::kScene &&
                                                   io::read_scene_json(inputs.source).mask_mode == MaskMode::kLabel);
  if (!has_masks) refuse("--all without --masks: expected masks of everything", remedy);
}

/// The scene of ngs-group as OUT/scene.json.
void CutChain::write_grouped_scene() const {
  const std::string grouped = at("groups/scene.json");
  io::write_scene_json(at("scene.json"), io::read_scene_json(grouped), io::StoredPaths::kRelative,
                       io::truth_of_scene_json(grouped));
  fs::copy_file(at("groups/objects.json"), at("objects.json"), fs::copy_options::overwrite_existing);
}

bool CutChain::cut_all() {
  if (inputs_.kind == SourceKind::kScene && !inputs_.model.empty() && !run_.dry_run()) {
    Scene scene = io::read_scene_json(plain_scene_);
    scene.model_path = inputs_.model;
    io::write_scene_json(at("capture.json"), scene, io::StoredPaths::kRelative, io::truth_of_scene_json(plain_scene_));
    plain_scene_ = at("capture.json");
  }
  Words group{"ngs-group", plain_scene_, "-o", at("groups")};
  if (!inputs_.masks.empty()) group.insert(group.end(), {"--masks", inputs_.masks});
  if (!stage("ngs-group", group)) return false;
  if (!run_.dry_run()) write_grouped_scene();
  if (!stage("ngs-variance",
             {"ngs-variance", at("scene.json"), "-o", at("boundary.ply"), "--min-mask-agreement", "-1"}))
    return false;
  Words joint{"ngs-joint", at("scene.json"), at("boundary.ply"), "-o", at("labelled.ply")};
  if (inputs_.trains_all)
    joint.insert(joint.end(), {"--quality", std::string(name_of(kQualityNames, options_.quality))});
  else
    joint.insert(joint.end(), {"--method", "flash"});
  if (!stage("ngs-joint", joint)) return false;
  std::error_code absent;
  if (!run_.dry_run()) fs::remove_all(at("objects"), absent);  // of an earlier run
  Words extract{"ngs-extract",    at("labelled.ply"), "--scene",
                at("scene.json"), "--background-ply", at("background.ply")};
  const bool is_one = !run_.dry_run() && io::read_scene_json(at("scene.json")).objects.size() == 1;
  if (is_one)  // ngs-extract writes folders of several objects only
    extract.insert(extract.end(), {"--object-ply", at("objects/001.ply")});
  else
    extract.insert(extract.end(), {"--objects", at("objects")});
  if (!options_.finish) extract.emplace_back("--no-finish");
  if (!stage("ngs-extract", extract)) return false;
  if (!stage("ngs-render", {"ngs-render", at("scene.json"), at("labelled.ply"), "--layers", "labels", "--format", "png",
                            "--views", "all", "-o", at("masks")}))
    return false;
  if (run_.dry_run()) return true;
  stages_.begin("page");
  io::write_file(at("report.html"), objects_page(io::read_scene_json(at("scene.json")),
                                                 Json(io::read_json_file(at("objects.json"))), at("masks")));
  if (!options_.keep) fs::remove(at("boundary.ply"));
  return true;
}

}  // namespace ngs::ngs_tool
