#include "ngs/io/capture/photo_names.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

/// The photo of this name, else the only one with its stem and any extension. Empty: none.
std::string find_photo(const FolderIndex& index, const std::string& name) {
  std::string same = index.find(name);
  if (!same.empty() && !has_unread_extension(same)) return same;
  std::string like = index.find_stem(name);
  return like.empty() ? same : like;
}

const SceneView& first_without_photo(const Capture& capture) {
  return *std::ranges::find_if(capture.views, [](const SceneView& view) { return view.image_path.empty(); });
}

/// Notes photos that were found by their stem.
void note_other_endings(const std::vector<SceneView*>& views, std::vector<std::string>& notes) {
  int count = 0;
  std::string first;
  for (const SceneView* view : views) {
    const fs::path named(view->camera.name), file(view->image_path);
    const bool known = has_image_extension(view->camera.name) || has_unread_extension(view->camera.name);
    if (file.empty() || !known || lower_case(named.extension().string()) == lower_case(file.extension().string()))
      continue;
    if (count++ == 0) first = view->camera.name + " is " + file.generic_string();
  }
  if (count > 0)
    notes.push_back(std::to_string(count) + " photos have another file extension than the cameras name (" + first +
                    ")");
}

/// Notes images in the photo folders that match no view: no camera was computed for them, or their photos were expected
/// elsewhere.
void note_unused_pictures(Capture& capture) {
  std::map<std::string, std::set<std::string>> used;  // names by folder
  for (const SceneView& view : capture.views)
    if (const fs::path file(view.image_path); !file.empty())
      used[file.parent_path().generic_string()].insert(file.filename().string());
  for (const auto& [folder, names] : used) {
    std::vector<std::string> others;
    for (const std::string& name : list_images(folder))
      if (!names.contains(name) && lower_case(name).find("mask") == name.npos) others.push_back(name);
    if (!others.empty())
      capture.notes.push_back(folder + ": " + std::to_string(others.size()) +
                              " images without a camera (first: " + others[0] + ")");
  }
}

/// Notes folders of photos, such as images_2, that are not used because another one is.
void note_other_photo_folders(const std::string& base, const std::string& used, Capture& capture) {
  std::string others;
  std::error_code ignored;
  for (const std::string& name : list_folders(base)) {
    const std::string folder = (fs::path(base) / name).generic_string(), lower = lower_case(name);
    const bool of_photos = lower.starts_with("image") || lower.starts_with("photo") || lower.starts_with("input");
    if (!of_photos || lower.find("mask") != lower.npos || fs::equivalent(folder, used, ignored)) continue;
    if (!find_photo(FolderIndex(folder), bare_name(capture.views[0].camera.name)).empty())
      others += (others.empty() ? "" : ", ") + name;
  }
  if (!others.empty())
    capture.notes.push_back(used + ": used for photos, not " + others + " (choose another with --images DIR)");
}

/// Notes other folders next to the cameras whose images have the names of views without a photo.
void note_folders_like(const std::string& base, Capture& capture) {
  const auto open = std::ranges::find_if(capture.views, [](const SceneView& view) { return view.image_path.empty(); });
  if (open == capture.views.end()) return;
  for (const std::string& name : list_folders(base)) {
    const std::string folder = (fs::path(base) / name).generic_string(), lower = lower_case(name);
    const bool of_masks = lower.find("mask") != lower.npos || lower.starts_with("gt") || lower.ends_with("_gt");
    if (of_masks) continue;
    if (!find_photo(FolderIndex(folder), bare_name(open->camera.name)).empty())
      capture.notes.push_back(folder +
                              ": holds pictures that are called like views without a photo, not read (if they are the "
                              "photos: --images " +
                              folder + ")");
  }
}

/// For a folder whose images match no view: what they are called.
std::string names_found_in(const std::string& folder) {
  const std::vector<std::string> images = folder.empty() ? std::vector<std::string>{} : list_images(folder);
  return images.empty() ? "" : "; " + folder + " has other names (first: " + images[0] + ")";
}

}  // namespace

std::string folder_with_photos(const std::vector<std::string>& folders, const Capture& capture) {
  for (const std::string& folder : folders) {
    const FolderIndex index(folder);
    for (const SceneView& view : capture.views)
      if (!is_regular_file(view.image_path) && !find_photo(index, bare_name(view.camera.name)).empty()) return folder;
  }
  return {};
}

void attach_photos(const PhotoFolder& folder, Capture& capture) {
  const FolderIndex index(folder.path);
  std::vector<SceneView*> open;
  std::vector<std::string> names;  // of these views
  for (SceneView& view : capture.views) {
    const bool own = !folder.is_named && is_regular_file(view.image_path);
    if (!own || has_unread_extension(view.image_path)) {
      open.push_back(&view);
      names.push_back(view.camera.name);
    }
  }
  const std::vector<FoundFile> found = files_of_views(names, [&](const std::string& name) {
    return folder.path.empty() ? FoundFile{} : FoundFile{find_photo(index, name), {}};
  });
  std::size_t missing = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const bool own = !folder.is_named && is_regular_file(open[i]->image_path);
    if (own && found[i].path.empty()) continue;  // keep the unreadable format for the error message
    open[i]->image_path = found[i].path;
    missing += found[i].path.empty();
  }
  if (missing == capture.views.size() && folder.is_named)
    throw Error(ErrorCode::kInconsistent, folder.path + ": no photo of any view (such as " +
                                              capture.views[0].camera.name + "), expected the photos of the cameras");
  note_other_endings(open, capture.notes);
  if (missing > 0)
    capture.notes.push_back("no photo for " + std::to_string(missing) + " of " + std::to_string(capture.views.size()) +
                            " views (first: " + first_without_photo(capture).camera.name + ")" +
                            (folder.path.empty() ? "; name their folder with --images DIR" : "") +
                            (missing == capture.views.size() ? names_found_in(folder.path) : ""));
}

void note_unused_photos(const std::string& base, Capture& capture) {
  note_unused_pictures(capture);
  note_folders_like(base, capture);
  const fs::path first = capture.views[0].image_path;
  if (!first.empty()) note_other_photo_folders(base, first.parent_path().generic_string(), capture);
}

}  // namespace ngs::io
