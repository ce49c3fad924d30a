#include "ngs/io/mask_names.h"

#include <filesystem>

#include "ngs/io/folder_index.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

struct Match {
  std::string path, rule;
};

Match find_mask(const FolderIndex& index, const std::string& name) {
  const std::string stem = image_stem(name);
  const Match tried[] = {{name + ".png", "<name>.png"},
                         {name, "<name>"},
                         {stem + ".png", "<stem>.png"},
                         {stem + ".mask.png", "<stem>.mask.png"}};
  for (const Match& candidate : tried) {
    const std::string path = index.find({candidate.path});
    if (!path.empty()) return {path, candidate.rule};
  }
  const std::string path = index.find_stem(name);
  return path.empty() ? Match{} : Match{path, "<stem>." + fs::path(path).extension().string().substr(1)};
}

/// "<folder>/cup/a/0001.png" with "cup" -> "<folder>/{object}/a/0001.png"
std::string with_object_field(const std::string& path, const std::string& object_folder,
                              const std::string& folder) {
  return (fs::path(folder) / "{object}" / fs::path(path).lexically_relative(object_folder)).string();
}

void match_plain(const std::string& folder, std::vector<SceneView>& views, MaskMatches& matches) {
  const FolderIndex index(folder);
  for (SceneView& view : views) {
    if (!view.mask_path.empty()) continue;
    const Match match = find_mask(index, view.camera.name);
    if (match.path.empty()) continue;
    view.mask_path = match.path;
    ++matches.views_by_rule[match.rule];
  }
}

void match_per_object(const std::string& folder, const std::vector<std::string>& candidates,
                      std::vector<SceneView>& views, MaskMatches& matches) {
  for (const std::string& object : candidates) {
    const std::string object_folder = (fs::path(folder) / object).string();
    const FolderIndex index(object_folder);
    bool has_any = false;
    for (SceneView& view : views) {
      const Match match = find_mask(index, view.camera.name);
      if (match.path.empty()) continue;
      has_any = true;
      if (!view.mask_path.empty()) continue;
      view.mask_path = with_object_field(match.path, object_folder, folder);
      ++matches.views_by_rule["<object>/" + match.rule];
    }
    if (has_any) matches.objects.push_back(object);
  }
}

}  // namespace

MaskMatches match_masks(const std::string& folder, const std::vector<std::string>& objects,
                        std::vector<SceneView>& views) {
  MaskMatches matches;
  for (const SceneView& view : views)
    if (!view.mask_path.empty()) ++matches.views_by_rule["mask_path of the source"];
  if (!folder.empty()) match_plain(folder, views, matches);
  if (!folder.empty() && matches.views_by_rule.empty())
    match_per_object(folder, objects.empty() ? list_folders(folder) : objects, views, matches);
  for (const SceneView& view : views)
    if (view.mask_path.empty()) matches.unmatched.push_back(view.camera.name);
  return matches;
}

}  // namespace ngs::io
