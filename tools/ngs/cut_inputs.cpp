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

namespace ngs::ngs_tool {

namespace fs = std::filesystem;

std::string splat_without_photos(const std::string& capture, const std::string& model, bool marked) {
  io::ImportRequest request;
  request.capture.source = capture, request.model_path = model;
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
  throw Error(ErrorCode::kBadInput, found.problem + ", expected one",
              "give the splat with --model PATH; to fit one to the photos: ngs-scene import " + io::shell_word(path) +
                  " -o scene.json, then ngs-fit scene.json -o model.ply");
}

}  // namespace ngs::ngs_tool
