#include "painted_pictures.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/json_file.h"

namespace ngs::front {

namespace fs = std::filesystem;

void record_pictures(const std::string& folder, const std::string& record) {
  nlohmann::json hashes = nlohmann::json::object();
  for (const std::string& name : io::list_images(folder)) hashes[name] = io::content_hash(folder + "/" + name).xxh3;
  io::write_file(record, hashes.dump(1) + "\n");
}

std::vector<std::string> rescue_painted(const std::string& folder, const std::string& record,
                                        const std::string& copies) {
  std::vector<std::string> painted;
  std::error_code absent;
  if (!fs::exists(record, absent)) return painted;
  const nlohmann::json hashes = io::read_json_file(record);
  for (const auto& [name, hash] : hashes.items()) {
    const fs::path picture = fs::path(folder) / name;
    if (!fs::exists(picture, absent) || io::content_hash(picture.string()).xxh3 == hash) continue;
    fs::create_directories(copies);
    fs::copy_file(picture, fs::path(copies) / name, fs::copy_options::overwrite_existing);
    painted.push_back(name);
  }
  return painted;
}

std::vector<std::string> strokes_on_copies(const std::vector<std::string>& strokes, const std::string& folder,
                                           const std::string& copies, const std::vector<std::string>& painted) {
  std::vector<std::string> out;
  std::error_code absent;
  for (const std::string& path : strokes) {
    const fs::path copy = fs::path(copies) / fs::path(path).filename();
    const bool in_place = fs::equivalent(fs::path(path).parent_path() / "", fs::path(folder) / "", absent);
    out.push_back(in_place && fs::exists(copy, absent) ? copy.string() : path);
  }
  for (const std::string& name : painted)
    if (const std::string copy = (fs::path(copies) / name).string(); !std::ranges::count(out, copy))
      out.push_back(copy);
  return out;
}

std::vector<std::string> not_in_folder(const std::vector<std::string>& strokes, const std::string& folder) {
  std::vector<std::string> out;
  std::error_code absent;
  for (const std::string& path : strokes)
    if (!fs::equivalent(fs::path(path).parent_path() / "", fs::path(folder) / "", absent)) out.push_back(path);
  return out;
}

}  // namespace ngs::front
