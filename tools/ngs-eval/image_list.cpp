#include "image_list.h"

#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/scene/view_names.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxFolders = 3;  // object, camera of a rig, and one more; also stops cyclic links

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

void add_images(const fs::path& folder, const std::string& prefix, std::vector<std::string>& names) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!is_hidden(entry.path()) && entry.is_regular_file() && has_image_extension(name))
      names.push_back(prefix + name);
  }
}

void add_images_below(const fs::path& folder, const std::string& prefix, int depth, std::vector<std::string>& names) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_hidden(entry.path()) || !entry.is_directory()) continue;
    const std::string below = prefix + entry.path().filename().string() + "/";
    add_images(entry.path(), below, names);
    if (depth < kMaxFolders) add_images_below(entry.path(), below, depth + 1, names);
  }
}

}  // namespace

ImageList list_images(const std::string& path) {
  if (!fs::is_directory(path)) {
    const fs::path file(path);
    return {file.has_parent_path() ? file.parent_path().generic_string() : ".", {file.filename().string()}};
  }
  ImageList list{path, {}};
  add_images(path, "", list.names);
  if (list.names.empty()) add_images_below(path, "", 1, list.names);
  std::sort(list.names.begin(), list.names.end());
  if (list.names.empty())
    throw Error(ErrorCode::kBadInput,
                path + ": no image found, expected PNG, JPEG, TIFF, BMP, WebP, PPM, PGM or EXR files");
  return list;
}

}  // namespace ngs::cli
