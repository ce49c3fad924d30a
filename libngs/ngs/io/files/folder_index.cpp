#include "ngs/io/files/folder_index.h"

#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

template <class Keep>
std::vector<std::string> list(const std::string& folder, const Keep& keep) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (std::string name = entry.path().filename().string(); !is_resource_fork(name) && keep(entry))
      names.push_back(std::move(name));
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

bool is_resource_fork(std::string_view name) { return name.starts_with("._") || name == "__MACOSX"; }

std::vector<std::string> list_images(const std::string& folder) {
  return list(folder, [](const fs::directory_entry& entry) {
    return has_image_extension(entry.path().filename().string()) && is_regular_file(entry.path().generic_string());
  });
}

void require_readable_folder(const std::string& folder) {
  std::error_code failed;
  const fs::directory_iterator first(folder, failed);
  if (!failed && first != fs::directory_iterator()) static_cast<void>(fs::status(first->path(), failed));
  if (failed == std::errc::permission_denied)
    throw Error(ErrorCode::kBadInput, folder + ": cannot be read: " + failed.message(),
                "give yourself the right to read it: chmod -R u+rX " + shell_word(folder));
}

std::vector<std::string> list_folders(const std::string& folder) {
  return list(folder, [](const fs::directory_entry& entry) {
    std::error_code ignored;
    return entry.is_directory(ignored);
  });
}

std::string folder_called(const std::string& folder, const std::string& name) {
  std::vector<std::string> alike;
  for (const std::string& found : list_folders(folder)) {
    if (found == name) return (fs::path(folder) / name).generic_string();
    if (lower_case(found) == lower_case(name)) alike.push_back(found);
  }
  return alike.size() == 1 ? (fs::path(folder) / alike[0]).generic_string() : std::string();
}

std::string FolderIndex::find(const std::string& name) const {
  const fs::path path = fs::path(folder_) / name;
  if (is_regular_file(path.generic_string())) return path.generic_string();
  const std::string file = path.filename().string(), stem = image_stem(file);
  if (stem == file) return {};
  const Stems& stems = stems_of(path.parent_path().generic_string());
  std::string found;
  const auto find_among = [&](const auto& range, const std::string& folded) {
    for (auto entry = range.first; entry != range.second; ++entry) {
      if (folded_name(entry->second) != folded) continue;
      if (!found.empty()) return found.clear();
      found = (path.parent_path() / entry->second).generic_string();
    }
  };
  const std::string folded = folded_name(file);
  find_among(stems.exact.equal_range(stem), folded);
  if (found.empty() && stems.exact.count(stem) == 0) find_among(stems.folded.equal_range(folded_name(stem)), folded);
  return found;
}

std::string FolderIndex::find_stem(const std::string& name) const {
  const fs::path stem(image_stem(name)), folder = fs::path(folder_) / stem.parent_path();
  const Stems& stems = stems_of(folder.generic_string());
  const std::string file = stem.filename().string(), folded = folded_name(file);
  const auto only = [&](const auto& of, const std::string& key) {
    return of.count(key) == 1 ? (folder / of.find(key)->second).lexically_normal().generic_string() : std::string();
  };
  return stems.exact.count(file) > 0 ? only(stems.exact, file) : only(stems.folded, folded);
}

const FolderIndex::Stems& FolderIndex::stems_of(const std::string& folder) const {
  const auto [it, is_new] = stems_.try_emplace(folder);
  if (is_new)
    for (const std::string& name : list_images(folder)) {
      it->second.exact.emplace(image_stem(name), name);
      it->second.folded.emplace(folded_name(image_stem(name)), name);
    }
  return it->second;
}

namespace {

[[noreturn]] void refuse_shared(const std::string& file, const std::string& one, const std::string& other,
                                const std::string& remedy) {
  throw Error(ErrorCode::kInconsistent,
              file + ": matches both views " + one + " and " + other + ", expected a file for each", remedy);
}

/// Of several views of one stem (0000.jpg, 0000.png), the one whose whole name the file repeats has it.
void part_equal_stems(const std::vector<std::string>& views, std::vector<FoundFile>& files) {
  std::map<std::string, std::vector<std::size_t>> owners;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (!files[i].path.empty()) owners[files[i].path].push_back(i);
  for (const auto& [path, of] : owners) {
    if (of.size() < 2) continue;
    const std::string file = fs::path(path).filename().string();
    const auto repeats = [&](std::size_t i) { return file.starts_with(bare_name(views[i])); };
    if (std::ranges::count_if(of, repeats) != 1)
      refuse_shared(path, views[of[0]], views[of[1]],
                    "name each after the whole name of its view, such as " + bare_name(views[of[0]]) + ".png");
    for (const std::size_t i : of)
      if (!repeats(i)) files[i] = {};
  }
}

}  // namespace

std::vector<FoundFile> files_of_views(const std::vector<std::string>& views, const FindFile& find) {
  std::vector<FoundFile> files;
  for (const std::string& view : views) files.push_back(find(view));
  part_equal_stems(views, files);
  std::map<std::string, std::string> owner;  // path -> view
  for (std::size_t i = 0; i < views.size(); ++i)
    if (!files[i].path.empty()) owner.emplace(files[i].path, views[i]);
  const auto owned_by_full_name = owner;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!files[i].path.empty()) continue;
    const FoundFile bare = find(bare_name(views[i]));
    if (bare.path.empty() || owned_by_full_name.contains(bare.path)) continue;
    const auto [other, is_free] = owner.emplace(bare.path, views[i]);
    if (!is_free) {
      const fs::path file(bare.path), folder = fs::path(views[i]).parent_path();
      refuse_shared(
          bare.path, other->second, views[i],
          "keep the folders of the view names: " + (file.parent_path() / folder / file.filename()).generic_string());
    }
    files[i] = bare;
  }
  return files;
}

}  // namespace ngs::io
