#include "ngs/io/capture/capture.h"

#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

ImageFinder images_on_disk() { return {is_regular_file, read_image_size}; }

namespace {

namespace fs = std::filesystem;

/// The folders and file of a name that leads out of the image folder, such as "/data/images/a.jpg", "../images/a.jpg"
/// or "C:/images/a.jpg", from where it leads to. Empty for all other names.
fs::path outer_path(const std::string& name) {
  const fs::path path = fs::path(name).lexically_normal();
  const bool has_drive = name.size() > 3 && name.substr(1, 2) == ":/";
  if (path.empty() || (!path.has_root_directory() && !has_drive && *path.begin() != "..")) return {};
  fs::path outer;
  for (const fs::path& part : path.relative_path())
    if (part != ".." && !(has_drive && part == name.substr(0, 2))) outer /= part;
  return outer;
}

/// Some programs store absolute paths, or paths relative to the model, instead of names in the image folder. Such names
/// become relative to the deepest folder that contains all of them.
void bring_names_into_folder(Capture& capture, const std::string& object) {
  std::vector<fs::path> outer;
  fs::path shared;
  std::size_t count = 0;
  std::string first;
  for (const SceneView& view : capture.views) {
    outer.push_back(outer_path(view.camera.name));
    if (outer.back().empty()) continue;
    const fs::path folder = outer.back().parent_path();
    if (count++ == 0) {
      shared = folder;
      first = view.camera.name;
    }
    while (std::mismatch(shared.begin(), shared.end(), folder.begin(), folder.end()).first != shared.end())
      shared = shared.parent_path();
  }
  for (std::size_t v = 0; v < outer.size(); ++v) {
    if (outer[v].empty()) continue;
    SceneView& view = capture.views[v];
    auto lens = capture.lenses.extract(view.camera.name);
    if (view.image_path.empty() && fs::path(view.camera.name).is_absolute()) view.image_path = view.camera.name;
    view.camera.name = (shared.empty() ? outer[v] : outer[v].lexically_relative(shared)).generic_string();
    if (lens.empty()) continue;
    lens.key() = view.camera.name;
    capture.lenses.insert(std::move(lens));
  }
  if (count > 0)
    capture.notes.push_back(object + ": names of " + std::to_string(count) +
                            " images are paths, read without the folders that they share (first: " + first + ")");
}

}  // namespace

void finish_capture(Capture& capture, const std::string& object) {
  if (capture.views.empty()) throw Error(ErrorCode::kBadInput, object + ": no cameras, expected at least one");
  bring_names_into_folder(capture, object);
  for (const SceneView& view : capture.views) validate_camera(view.camera, object);
  std::stable_sort(capture.views.begin(), capture.views.end(),
                   [](const SceneView& a, const SceneView& b) { return a.camera.name < b.camera.name; });
  const auto same =
      std::adjacent_find(capture.views.begin(), capture.views.end(),
                         [](const SceneView& a, const SceneView& b) { return a.camera.name == b.camera.name; });
  if (same != capture.views.end())
    throw Error(ErrorCode::kBadInput, object + ": image " + same->camera.name + " is listed twice, expected once");
}

}  // namespace ngs::io
