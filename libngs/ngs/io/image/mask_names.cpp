#include "ngs/io/image/mask_names.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

FoundFile find_mask(const FolderIndex& index, const std::string& name) {
  const std::string stem = image_stem(name);
  const FoundFile tried[] = {{name + ".png", "<name>.png"},
                             {name, "<name>"},
                             {stem + ".png", "<stem>.png"},
                             {stem + ".mask.png", "<stem>.mask.png"},
                             {stem + "_mask.png", "<stem>_mask.png"}};
  FoundFile first;
  for (const FoundFile& candidate : tried) {
    const std::string path = index.find(candidate.path);
    if (path.empty() || path == first.path) continue;
    if (!first.path.empty()) return {first.path, first.rule, path};
    first = {path, candidate.rule};
  }
  if (!first.path.empty()) return first;
  const std::string path = index.find_stem(name);
  return path.empty() ? FoundFile{} : FoundFile{path, "<stem>." + fs::path(path).extension().string().substr(1)};
}

std::vector<FoundFile> find_masks(const std::string& folder, const std::vector<SceneView*>& views,
                                  MaskMatches& matches) {
  const FolderIndex index(folder);
  std::vector<std::string> names;
  for (const SceneView* view : views) names.push_back(view->camera.name);
  std::vector<FoundFile> found = files_of_views(names, [&](const std::string& name) { return find_mask(index, name); });
  for (const FoundFile& file : found)
    if (!file.beside_it.empty() && matches.several++ == 0)
      matches.taken = file.path, matches.not_taken = file.beside_it;
  return found;
}

/// "<folder>/cup/a/0001.png" with "cup" -> "<folder>/{object}/a/0001.png"
std::string with_object_field(const std::string& path, const std::string& object_folder, const std::string& folder) {
  return (fs::path(folder) / "{object}" / fs::path(path).lexically_relative(object_folder)).string();
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
    const std::string object_folder = (fs::path(folder) / object).string();
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
        throw Error(
            ErrorCode::kInconsistent,
            found[v].path + ": another object has " + kept + ", expected one name in the folders of all objects",
            "rename the masks alike");
    }
    if (has_any) matches.objects.push_back(object);
  }
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
  return matches;
}

}  // namespace ngs::io
