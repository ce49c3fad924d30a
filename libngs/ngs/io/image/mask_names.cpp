#include "ngs/io/image/mask_names.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

/// By name, with numbers in it by value: 2 before 10.
bool in_order(const std::string& a, const std::string& b) {
  const auto key = [](const std::string& name) {  // every number gets the same length
    constexpr std::size_t kDigits = 20;
    std::string key;
    for (std::size_t at = 0; at < name.size();) {
      const std::size_t end = std::min(name.find_first_not_of("0123456789", at), name.size());
      if (end > at) key += std::string(kDigits - std::min(kDigits, end - at), '0') + name.substr(at, end - at);
      if (end < name.size()) key += name[end];
      at = end + 1;
    }
    return key;
  };
  return std::pair(key(a), a) < std::pair(key(b), b);
}

/// `photos`: the views' photos, which may lie in the same folder and are never masks.
FoundFile find_mask(const FolderIndex& index, const std::set<fs::path>& photos, const std::string& name) {
  const std::string stem = image_stem(name);
  const FoundFile tried[] = {{name + ".png", "<name>.png"},           {name, "<name>"},
                             {stem + ".png", "<stem>.png"},           {stem + ".mask.png", "<stem>.mask.png"},
                             {name + ".mask.png", "<name>.mask.png"}, {stem + "_mask.png", "<stem>_mask.png"},
                             {stem + "-mask.png", "<stem>-mask.png"}, {"mask_" + stem + ".png", "mask_<stem>.png"}};
  const auto is_photo = [&](const std::string& path) { return photos.contains(fs::path(path).lexically_normal()); };
  FoundFile first;
  for (const FoundFile& candidate : tried) {
    const std::string path = index.find(candidate.path);
    if (path.empty() || path == first.path || is_photo(path)) continue;
    if (!first.path.empty()) return {first.path, first.rule, path};
    first = {path, candidate.rule};
  }
  if (!first.path.empty()) return first;
  for (const char* ending : {".jpg.png", ".jpeg.png"})
    if (const std::string path = index.find(stem + ending); !path.empty() && !is_photo(path))
      return {path, std::string("<stem>") + ending};
  std::string flat = stem;
  std::ranges::replace(flat, '/', '_');
  if (flat != stem)
    if (const std::string path = index.find(flat + ".png"); !path.empty()) return {path, "<folder>_<stem>.png"};
  const std::string path = index.find_stem(name);
  return path.empty() || is_photo(path) ? FoundFile{}
                                        : FoundFile{path, "<stem>." + fs::path(path).extension().string().substr(1)};
}

using NameOf = std::function<std::string(const SceneView&)>;  // that masks of a view are called after
std::string own_name(const SceneView& view) { return view.camera.name; }

std::vector<FoundFile> find_masks(const std::string& folder, const std::vector<SceneView*>& views,
                                  const NameOf& name_of, MaskMatches& matches) {
  const FolderIndex index(folder);
  std::vector<std::string> names;
  std::set<fs::path> photos;
  for (const SceneView* view : views) {
    names.push_back(name_of(*view));
    photos.insert(fs::path(view->image_path).lexically_normal());
  }
  std::vector<FoundFile> found =
      files_of_views(names, [&](const std::string& name) { return find_mask(index, photos, name); });
  for (const FoundFile& file : found)
    if (!file.unused_candidate.empty() && matches.several++ == 0) {
      matches.taken = file.path;
      matches.not_taken = file.unused_candidate;
    }
  return found;
}

/// "<folder>/cup/a/0001.png" with object "cup" -> "<folder>/{object}/a/0001.png"
std::string with_object_field(const std::string& path, const std::string& object_folder, const std::string& folder) {
  return (fs::path(folder) / "{object}" / fs::path(path).lexically_relative(object_folder)).generic_string();
}

/// The inverse.
std::string of_object(std::string path, const std::string& object) {
  const std::string field = "{object}";
  const std::size_t at = path.find(field);
  return at == std::string::npos ? path : path.replace(at, field.size(), object);
}

void match_plain(const std::string& folder, const std::vector<SceneView*>& views, MaskMatches& matches) {
  const std::vector<FoundFile> found = find_masks(folder, views, own_name, matches);
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (found[v].path.empty()) continue;
    views[v]->mask_path = found[v].path;
    ++matches.views_by_rule[found[v].rule];
  }
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Numbers without zeros in front: "img_7" for "img_0007".
std::string without_zeros(const std::string& name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool is_in_front = i + 1 < name.size() && is_digit(name[i + 1]) && (out.empty() || !is_digit(out.back()));
    if (name[i] != '0' || !is_in_front) out += name[i];
  }
  return out;
}

/// What all masks have around the stems of their views, such as "seg_" and "_0". None: no two of them the same, or
/// several masks of one view.
std::optional<std::pair<std::string, std::string>> common_affixes(const std::vector<std::string>& masks,
                                                                  const std::vector<std::string>& stems) {
  std::map<std::pair<std::string, std::string>, int> count;  // views
  for (const std::string& mask : masks)
    for (const std::string& stem : stems) {
      const std::size_t at = mask.find(stem);
      if (at == mask.npos) continue;
      const std::string before = mask.substr(0, at), after = mask.substr(at + stem.size());
      const bool is_part_of_number = (!before.empty() && is_digit(before.back()) && is_digit(stem.front())) ||
                                     (!after.empty() && is_digit(after.front()) && is_digit(stem.back()));
      if (!is_part_of_number) ++count[{before, after}];
    }
  const auto most = std::ranges::max_element(count, {}, [](const auto& entry) { return entry.second; });
  const auto frequent = std::ranges::count_if(count, [](const auto& entry) { return entry.second > 1; });
  if (frequent != 1) return std::nullopt;
  return most->first;
}

void match_affixed(const std::string& folder, const std::vector<SceneView*>& views, MaskMatches& matches) {
  std::map<std::string, std::string> files;  // by name without zeros and extension; empty: several
  std::vector<std::string> masks, stems;
  std::set<fs::path> photos;
  for (const SceneView* view : views) photos.insert(fs::path(view->image_path).lexically_normal());
  for (const std::string& image : list_images(folder)) {
    if (photos.contains((fs::path(folder) / image).lexically_normal())) continue;
    const auto [entry, is_new] = files.try_emplace(without_zeros(image_stem(image)), image);
    if (!is_new) entry->second.clear();
  }
  for (const auto& [name, file] : files) masks.push_back(name);
  for (const SceneView* view : views) stems.push_back(without_zeros(image_stem(bare_name(view->camera.name))));
  const auto affixes = common_affixes(masks, stems);
  if (!affixes) return;
  const auto& [before, after] = *affixes;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto found = files.find(before + stems[v] + after);
    if (found == files.end() || found->second.empty() || std::ranges::count(stems, stems[v]) > 1) continue;
    views[v]->mask_path = (fs::path(folder) / found->second).generic_string();
    ++matches.views_by_rule[before + "<stem>" + after];
  }
}

/// Masks in <folder>/<object>/<camera>/ or, if `cameras_first`, in <folder>/<camera>/<object>/.
void match_per_object(const std::string& folder, const std::vector<std::string>& candidates, bool cameras_first,
                      const std::vector<SceneView*>& views, MaskMatches& matches) {
  for (const std::string& object : candidates) {
    const std::string object_folder = cameras_first ? folder : (fs::path(folder) / object).generic_string();
    const auto in_camera = [&](const SceneView& view) {
      const fs::path name = view.camera.name;
      return (name.parent_path() / object / name.filename()).generic_string();
    };
    const std::vector<FoundFile> found =
        find_masks(object_folder, views, cameras_first ? NameOf(in_camera) : own_name, matches);
    bool has_any = false;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const fs::path in = fs::path(found[v].path).parent_path();
      if (found[v].path.empty() || (cameras_first && in.filename() != object)) continue;
      has_any = true;
      const std::string path =
          cameras_first ? (in.parent_path() / "{object}" / fs::path(found[v].path).filename()).generic_string()
                        : with_object_field(found[v].path, object_folder, folder);
      std::string& kept = views[v]->mask_path;
      if (kept.empty()) {
        kept = path;
        ++matches.views_by_rule["<object>/" + found[v].rule];
      } else if (kept != path)
        throw Error(ErrorCode::kInconsistent,
                    found[v].path + ": another object has " + kept + ", expected the same file name for all objects",
                    "give the masks of a view the same name in all object folders; if only one of these folders holds "
                    "masks: --masks " +
                        shell_word(object_folder));
    }
    if (has_any) matches.objects.push_back(object);
  }
}

std::set<std::string> camera_folders(const std::vector<SceneView>& views) {
  std::set<std::string> folders;
  for (const SceneView& view : views)
    if (const fs::path in = fs::path(view.camera.name).parent_path(); !in.empty()) folders.insert(in.generic_string());
  return folders;
}

/// Image files in the mask folders, or in `folder` if there is none, that are neither a view's mask nor a photo.
/// `candidates`: the sub-folders that may hold masks.
void note_unused(const std::string& folder, const std::vector<std::string>& candidates,
                 const std::vector<SceneView>& views, MaskMatches& matches) {
  if (folder.empty()) return;
  std::set<fs::path> used, folders{fs::path(folder).lexically_normal()};
  const std::vector<std::string> one{""}, &objects = matches.objects.empty() ? one : matches.objects;
  for (const SceneView& view : views) {
    used.insert(fs::path(view.image_path).lexically_normal());
    for (const std::string& object : objects) {
      const fs::path mask = fs::path(of_object(view.mask_path, object)).lexically_normal();
      used.insert(mask);
      if (!mask.empty()) folders.insert(mask.parent_path());
    }
  }
  for (const std::string& name : candidates)
    if (!name.starts_with(".")) folders.insert((fs::path(folder) / name).lexically_normal());
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
  if (!folder.empty() && matches.views_by_rule.empty()) match_affixed(folder, open, matches);
  if (!folder.empty() && objects.empty() &&
      matches.views_by_rule.empty())  // as of an archive that was unpacked in its own folder
    for (const std::string& name : {fs::path(folder).filename().string(), std::string("masks")})
      if (!name.empty() && matches.views_by_rule.empty())
        match_plain((fs::path(folder) / name).string(), open, matches);
  const std::vector<std::string> candidates = objects.empty() ? list_folders(folder) : objects;
  if (!folder.empty() && matches.views_by_rule.empty()) match_per_object(folder, candidates, false, open, matches);
  if (!folder.empty() && matches.views_by_rule.empty()) {
    std::set<std::string> in_cameras(objects.begin(), objects.end());
    for (const std::string& camera : camera_folders(views))
      for (const std::string& name : list_folders((fs::path(folder) / camera).string()))
        if (objects.empty()) in_cameras.insert(name);
    match_per_object(folder, {in_cameras.begin(), in_cameras.end()}, true, open, matches);
  }
  for (const SceneView& view : views)
    if (view.mask_path.empty()) matches.unmatched.push_back(view.camera.name);
  note_unused(folder, candidates, views, matches);
  return matches;
}

MaskMatches pair_masks_in_order(const std::string& folder, std::vector<SceneView>& views) {
  std::vector<std::string> masks = list_images(folder);
  if (masks.size() != views.size())
    throw Error(ErrorCode::kInconsistent,
                folder + ": " + std::to_string(masks.size()) + " images for " + std::to_string(views.size()) +
                    " views, expected as many, to pair them in order",
                "leave out --masks-in-order, and name each mask after its photo");
  std::ranges::sort(masks, in_order);
  std::vector<SceneView*> sorted;
  for (SceneView& view : views) sorted.push_back(&view);
  std::ranges::sort(sorted, in_order, [](const SceneView* view) { return view->camera.name; });
  for (std::size_t v = 0; v < views.size(); ++v) sorted[v]->mask_path = (fs::path(folder) / masks[v]).generic_string();
  MaskMatches matches;
  matches.views_by_rule["in order"] = int(views.size());
  return matches;
}

void shift_masks(int shift, std::vector<SceneView>& views, MaskMatches& matches) {
  struct Named {
    std::string name, mask;
    SceneView* view = nullptr;
  };
  std::vector<Named> all;
  for (SceneView& view : views) all.push_back({image_stem(view.camera.name), view.mask_path, &view});
  for (const std::string& mask : matches.of_no_view) all.push_back({image_stem(bare_name(mask)), mask});
  std::ranges::sort(all, in_order, &Named::name);
  std::set<std::string> unused(matches.of_no_view.begin(), matches.of_no_view.end());
  matches.unmatched.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].view == nullptr) continue;
    const std::size_t from = i + std::size_t(shift);  // beyond the end: none
    all[i].view->mask_path = from < all.size() ? all[from].mask : "";
    unused.erase(all[i].view->mask_path);
    if (all[i].view->mask_path.empty()) matches.unmatched.push_back(all[i].view->camera.name);
  }
  matches.of_no_view.assign(unused.begin(), unused.end());
}

bool photo_folder_holds_masks(const std::string& folder, const std::vector<SceneView>& views) {
  const FolderIndex index(folder);
  return std::ranges::any_of(views, [&](const SceneView& view) {
    const std::string name = bare_name(view.camera.name), stem = image_stem(name);
    return !(index.find(name + ".mask.png") + index.find(stem + ".mask.png") + index.find(stem + "_mask.png")).empty();
  });
}

}  // namespace ngs::io
