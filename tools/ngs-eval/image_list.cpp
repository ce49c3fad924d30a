#include "image_list.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "ngs/core/error.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

bool is_image(const fs::path& path) {
  constexpr std::array kExtensions = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".exr"};
  std::string extension = path.extension().string();
  for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

void add_images(const fs::path& folder, const std::string& prefix, std::vector<std::string>& names) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name[0] != '.' && entry.is_regular_file() && is_image(entry.path())) names.push_back(prefix + name);
  }
}

}  // namespace

ImageList list_images(const std::string& path) {
  if (!fs::is_directory(path)) {
    const fs::path file(path);
    return {file.has_parent_path() ? file.parent_path().string() : ".", {file.filename().string()}};
  }
  ImageList list{path, {}};
  add_images(path, "", list.names);
  if (list.names.empty())
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
      const std::string name = entry.path().filename().string();
      if (name[0] != '.' && entry.is_directory()) add_images(entry.path(), name + "/", list.names);
    }
  std::sort(list.names.begin(), list.names.end());
  if (list.names.empty())
    throw Error(ErrorCode::kBadInput, path + ": no image found, expected PNG, JPEG, TIFF, BMP or EXR files");
  return list;
}

std::vector<std::string> read_lines(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::kBadInput, path + ": cannot be read, expected a text file of names");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  }
  return lines;
}

}  // namespace ngs::cli
