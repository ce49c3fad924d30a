#include "cut_source.h"

#include <cstring>
#include <filesystem>
#include <initializer_list>

#include "ngs/core/error.h"
#include "ngs/io/files/json_file.h"

namespace ngs::front {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& path) {
  std::error_code unreadable;
  return fs::is_directory(path, unreadable) ? fs::path(path) : fs::path(path).parent_path();
}

std::string first_of(const std::string& path, std::initializer_list<const char*> names) {
  std::error_code unreadable;
  for (const char* name : names)
    if (const fs::path found = folder_of(path) / name; fs::exists(found, unreadable)) return found.string();
  return {};
}

/// point_cloud/iteration_30000/point_cloud.ply of the Inria trainer: the last one.
std::string trained_model(const std::string& path) {
  std::error_code unreadable;
  std::string last;
  long most = -1;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_of(path) / "point_cloud", unreadable)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("iteration_") || name.find_first_not_of("0123456789", 10) != name.npos) continue;
    const long iteration = std::strtol(name.c_str() + 10, nullptr, 10);
    const fs::path model = entry.path() / "point_cloud.ply";
    if (iteration > most && fs::exists(model, unreadable)) most = iteration, last = model.string();
  }
  return last;
}

}  // namespace

SourceKind kind_of(const std::string& path) {
  std::error_code unreadable;
  if (!fs::exists(path, unreadable))
    throw Error(ErrorCode::kBadInput, path + ": no such file or folder, expected a splat, a capture or a scene.json");
  const std::string extension = fs::path(path).extension().string();
  if (fs::is_directory(path, unreadable) || extension == ".npy") return SourceKind::kCapture;
  if (extension != ".json") return SourceKind::kSplat;
  const nlohmann::json root = io::read_json_file(path);
  return root.is_object() && root.contains("ngs_scene") ? SourceKind::kScene : SourceKind::kCapture;
}

std::string model_in(const std::string& path) {
  const std::string plain = first_of(path, {"point_cloud.ply", "model.ply"});
  return plain.empty() ? trained_model(path) : plain;
}
std::string masks_in(const std::string& path) { return first_of(path, {"masks", "masks_sam"}); }
std::string truth_in(const std::string& path) { return first_of(path, {"masks_gt", "gt"}); }

}  // namespace ngs::front
