#include "cut_inputs.h"

#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/core/folded_name.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/capture/foreign_source.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/formats/compression/packed_model.h"
#include "ngs/io/scene/find_model.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/io/scene/scene_json.h"

namespace ngs::ngs_tool {

namespace fs = std::filesystem;

namespace {

/// How to export the splat of a trainer's checkpoint in the folder; empty: there is none.
std::string export_of_checkpoint(const std::string& folder) {
  constexpr int kMaxDepth = 5;
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (entry.depth() >= kMaxDepth) entry.disable_recursion_pending();
    const fs::path& file = entry->path();
    const std::string config = (file.parent_path().parent_path() / "config.yml").generic_string();
    if (file.extension() == ".ckpt" && exists(config))
      return "export the splat of " + file.generic_string() +
             " with nerfstudio: ns-export gaussian-splat --load-config " + io::shell_word(config) + " --output-dir " +
             io::shell_word((fs::path(folder) / "exports").generic_string());
    if (file.extension() == ".pt" && file.filename().string().starts_with("ckpt_"))
      return file.generic_string() + " is a checkpoint of gsplat: train with --save_ply, which writes the splat";
  }
  return {};
}

}  // namespace

std::string splat_without_photos(const std::string& capture, const std::string& model, bool marked) {
  io::ImportRequest request;
  request.capture.source = capture;
  request.model_path = model;
  try {
    const Scene scene = io::import_scene(request).scene;
    const bool is_bare = std::ranges::all_of(scene.views, [&](const SceneView& view) {
      return view.image_path.empty() && (marked || view.mask_path.empty());
    });
    return is_bare ? scene.model_path : "";
  } catch (const Error&) {
    return {};
  }
}

bool exists(const std::string& path) {
  std::error_code unreadable;
  return !path.empty() && fs::exists(path, unreadable);
}

SourceKind kind_of(const std::string& path) {
  std::error_code unreadable;
  io::refuse_foreign_file(path);
  if (!fs::exists(path, unreadable))
    throw Error(ErrorCode::kBadInput, path + ": no such file or folder, expected a splat, a capture or a scene.json");
  const std::string extension = lower_case(fs::path(path).extension().string());
  if (fs::is_directory(path, unreadable) || extension == ".npy") return SourceKind::kCapture;
  if (extension == ".txt" || extension == ".bin") return SourceKind::kCapture;  // of a COLMAP model
  if (extension != ".json") return SourceKind::kSplat;
  const nlohmann::json root = io::read_json_file(path);
  if (root.is_object() && root.contains("ngs_scene")) return SourceKind::kScene;
  return io::sog_kind(root).empty() ? SourceKind::kCapture : SourceKind::kSplat;
}

void require_model_in(const std::string& path) {
  if (fs::path(path).filename() == "scene.json") return;
  const std::string folder = io::capture_folder(path);
  const io::ModelSearch found = io::find_model(folder);
  std::error_code unreadable;
  if (!found.path.empty() || fs::exists(fs::path(folder) / "scene.json", unreadable)) return;
  const std::string checkpoint = export_of_checkpoint(folder);
  throw Error(ErrorCode::kBadInput, found.problem + ", expected one",
              !checkpoint.empty() ? checkpoint
                                  : "give the splat with --model PATH; to fit one to the photos: ngs-scene import " +
                                        io::shell_word(path) + " -o scene.json, then ngs-fit scene.json -o model.ply");
}

}  // namespace ngs::ngs_tool
