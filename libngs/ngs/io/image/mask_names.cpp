#include "ngs/io/image/mask_names.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

/// `photos`: the views' photos, which may lie in the same folder and are never masks.
FoundFile find_mask(const FolderIndex& index, const std::set<fs::path>& photos, const std::string& name) {
  const std::string stem = image_stem(name);
  const FoundFile tried[] = {{name + ".png", "<name>.png"},           {name, "<name>"},
                             {stem + ".png", "<stem>.png"},           {stem + ".mask.png", "<stem>.mask.png"},
                             {name + ".mask.png", "<name>.mask.png"}, {stem + "_mask.png", "<stem>_mask.png"}};
  const auto is_photo = [&](const std::string& path) { return photos.contains(fs::path(path).lexically_normal()); };
  FoundFile first;
  for (const FoundFile& candidate : tried) {
    const std::string path = index.find(candidate.path);
    if (path.empty() || path == first.path || is_photo(path)) continue;
    if (!first.path.empty()) return {first.path, first.rule, path};
    first = {path, candidate.rule};
  }
  if (!first.path.empty()) return first;
  const std::string path = index.find_stem(name);
  return path.empty() || is_photo(path) ? FoundFile{}
                                        : FoundFile{path, "<stem>." + fs::path(path).extension().string().substr(1)};
}

std::vector<FoundFile> find_masks(const std::string& folder, const std::vector<SceneView*>& views,
                                  MaskMatches& matches) {
  const FolderIndex index(folder);
  std::vector<std::string> names;
  std::set<fs::path> photos;
  for (const SceneView* view : views) {
    names.push_back(view->camera.name);
    photos.insert(fs::path(view->image_path).lexically_normal());
  }
  std::vector<FoundFile> found =
      files_of_views(names, [&](const std::string& name) { return find_mask(index, photos, name); });
  for (const FoundFile& file : found)
    if (!file.unused_candidate.empty() && matches.several++ == 0)
      matches.taken = file.path, matches.not_taken = file.unused_candidate;
  return found;
}

/// "<folder>/cup/a/0001.png" with object "cup" -> "<folder>/{object}/a/0001.png"
std::string with_object_field(const std::string& path, const std::string& object_folder, const std::string& folder) {
  return (fs::path(folder) / "{object}" / fs::path(path).lexically_relative(object_folder)).generic_string();
}

void match_plain(const std::string& folder, const std::vector<SceneView*>& views, MaskMatches& matches) {
  const std::vector<FoundFile> found = find_masks(folder, views, matches);
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (found[v].path.empty()) continue;
    views[v]->mask_path = found[v].path;
    ++matches.views_by_rule[found[v].rule];
  }
}

void match_per_object(const std::string& folder, const std::vector<std::string>& candidates,
                      const std::vector<SceneView*>& views, MaskMatches& matches) {
  for (const std::string& object : candidates) {
    const std::string object_folder = (fs::path(folder) / object).generic_string();
    const std::vector<FoundFile> found = find_masks(object_folder, views, matches);
    bool has_any = false;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (found[v].path.empty()) continue;
      has_any = true;
      const std::string path = with_object_field(found[v].path, object_folder, folder);
      std::string& kept = views[v]->mask_path;
      if (kept.empty())
        kept = path, ++matches.views_by_rule["<object>/" + found[v].rule];
      else if (kept != path)
        throw Error(ErrorCode::kInconsistent,
                    found[v].path + ": another object has " + kept + ", expected the same file name for all objects",
                    "give the masks of a view the same name in all object folders");
    }
    if (has_any) matches.objects.push_back(object);
  }
}

/// Image files in the mask folders, or in `folder` if there is none, that are neither a view's mask nor a photo.
void note_unused(const std::string& folder, const std::vector<SceneView>& views, MaskMatches& matches) {
  if (!matches.objects.empty() || folder.empty()) return;
  std::set<fs::path> used, folders{fs::path(folder).lexically_normal()};
  for (const SceneView& view : views) {
    const fs::path mask = fs::path(view.mask_path).lexically_normal();
    used.insert(mask), used.insert(fs::path(view.image_path).lexically_normal());
    if (!mask.empty()) folders.insert(mask.parent_path());
  }
  for (const std::string& name : list_folders(folder)) folders.insert((fs::path(folder) / name).lexically_normal());
  for (const fs::path& of_masks : folders)
    for (const std::string& name : list_images(of_masks.generic_string()))
      if (!used.contains(of_masks / name)) matches.of_no_view.push_back((of_masks / name).generic_string());
}

}  // namespace

MaskMatches match_masks(const std::string& folder, const std::vector<std::string>& objects,
                        std::vector<SceneView>& views) {
  MaskMatches matches;
  std::vector<SceneView*> open;
  for (SceneView& view : views)
    if (view.mask_path.empty())
      open.push_back(&view);
    else
      ++matches.views_by_rule["mask_path of the source"];
  if (!folder.empty()) match_plain(folder, open, matches);
  if (!folder.empty() && matches.views_by_rule.empty())
    match_per_object(folder, objects.empty() ? list_folders(folder) : objects, open, matches);
  for (const SceneView& view : views)
    if (view.mask_path.empty()) matches.unmatched.push_back(view.camera.name);
  note_unused(folder, views, matches);
  return matches;
}

bool photo_folder_holds_masks(const std::string& folder, const std::vector<SceneView>& views) {
  const FolderIndex index(folder);
  return std::ranges::any_of(views, [&](const SceneView& view) {
    const std::string name = bare_name(view.camera.name), stem = image_stem(name);
    return !(index.find(name + ".mask.png") + index.find(stem + ".mask.png") + index.find(stem + "_mask.png")).empty();
  });
}

}  // namespace ngs::io
