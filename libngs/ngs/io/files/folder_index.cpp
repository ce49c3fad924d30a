#include "ngs/io/files/folder_index.h"

#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/regular_file.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

template <class Keep>
std::vector<std::string> list(const std::string& folder, const Keep& keep) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (keep(entry)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::vector<std::string> list_images(const std::string& folder) {
  return list(folder, [](const fs::directory_entry& entry) {
    return has_image_extension(entry.path().filename().string()) && is_regular_file(entry.path().string());
  });
}

std::vector<std::string> list_folders(const std::string& folder) {
  return list(folder, [](const fs::directory_entry& entry) {
    std::error_code ignored;
    return entry.is_directory(ignored);
  });
}

std::string lower_case(std::string_view name) {
  std::string lower(name);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return lower;
}

std::string folder_called(const std::string& folder, const std::string& name) {
  std::vector<std::string> alike;
  for (const std::string& found : list_folders(folder)) {
    if (found == name) return (fs::path(folder) / name).string();
    if (lower_case(found) == lower_case(name)) alike.push_back(found);
  }
  return alike.size() == 1 ? (fs::path(folder) / alike[0]).string() : std::string();
}

std::string FolderIndex::find(const std::string& name) const {
  const fs::path path = fs::path(folder_) / name;
  if (is_regular_file(path.string())) return path.string();
  const std::string file = path.filename().string(), stem = image_stem(file);
  if (stem == file) return {};
  std::string found;
  const auto [begin, end] = stems_of(path.parent_path().string()).equal_range(stem);
  for (auto entry = begin; entry != end; ++entry) {
    if (lower_case(entry->second) != lower_case(file)) continue;
    if (!found.empty()) return {};
    found = (path.parent_path() / entry->second).string();
  }
  return found;
}

std::string FolderIndex::find_stem(const std::string& name) const {
  const fs::path stem(image_stem(name)), folder = fs::path(folder_) / stem.parent_path();
  const auto& stems = stems_of(folder.string());
  if (stems.count(stem.filename().string()) != 1) return {};
  return (folder / stems.find(stem.filename().string())->second).lexically_normal().string();
}

const std::multimap<std::string, std::string>& FolderIndex::stems_of(const std::string& folder) const {
  const auto [it, is_new] = stems_.try_emplace(folder);
  if (is_new)
    for (const std::string& name : list_images(folder)) it->second.emplace(image_stem(name), name);
  return it->second;
}

std::vector<FoundFile> files_of_views(const std::vector<std::string>& views, const FindFile& find) {
  std::vector<FoundFile> files;
  std::map<std::string, std::string> owner;  // path -> view
  for (const std::string& view : views) {
    files.push_back(find(view));
    if (!files.back().path.empty()) owner.emplace(files.back().path, view);
  }
  const auto owned_by_full_name = owner;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!files[i].path.empty()) continue;
    const FoundFile bare = find(bare_name(views[i]));
    if (bare.path.empty() || owned_by_full_name.contains(bare.path)) continue;
    const auto [other, is_free] = owner.emplace(bare.path, views[i]);
    if (!is_free) {
      const fs::path file(bare.path), folder = fs::path(views[i]).parent_path();
      throw Error(
          ErrorCode::kInconsistent,
          bare.path + ": matches both views " + other->second + " and " + views[i] + ", expected a file for each",
          "keep the folders of the view names: " + (file.parent_path() / folder / file.filename()).string());
    }
    files[i] = bare;
  }
  return files;
}

}  // namespace ngs::io
