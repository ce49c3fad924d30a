#include "ngs/io/folder_index.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "ngs/io/regular_file.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

bool is_image_extension(std::string extension) {
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  constexpr std::array kKnown{".png",  ".jpg",  ".jpeg", ".exr", ".tif",
                              ".tiff", ".webp", ".bmp",  ".ppm", ".pgm"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

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

std::string image_stem(const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  return is_image_extension(extension) ? name.substr(0, name.size() - extension.size()) : name;
}

std::vector<std::string> list_images(const std::string& folder) {
  return list(folder, [](const fs::directory_entry& entry) {
    return is_image_extension(entry.path().extension().string()) && is_regular_file(entry.path().string());
  });
}

std::vector<std::string> list_folders(const std::string& folder) {
  return list(folder, [](const fs::directory_entry& entry) {
    std::error_code ignored;
    return entry.is_directory(ignored);
  });
}

std::string FolderIndex::find(const std::vector<std::string>& names) const {
  for (const std::string& name : names)
    for (const fs::path& spelled : {fs::path(name), fs::path(name).filename()}) {
      const std::string path = (fs::path(folder_) / spelled).string();
      if (is_regular_file(path)) return path;
    }
  return {};
}

std::string FolderIndex::find_stem(const std::string& name) const {
  const fs::path stem(image_stem(name));
  for (const fs::path& folder : {fs::path(folder_) / stem.parent_path(), fs::path(folder_)}) {
    const auto& stems = stems_of(folder.string());
    if (stems.count(stem.filename().string()) == 1)
      return (folder / stems.find(stem.filename().string())->second).lexically_normal().string();
  }
  return {};
}

const std::multimap<std::string, std::string>& FolderIndex::stems_of(const std::string& folder) const {
  const auto [it, is_new] = stems_.try_emplace(folder);
  if (is_new)
    for (const std::string& name : list_images(folder)) it->second.emplace(image_stem(name), name);
  return it->second;
}

}  // namespace ngs::io
