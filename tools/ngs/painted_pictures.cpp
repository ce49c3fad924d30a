#include "painted_pictures.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/json_file.h"
#include "ngs/scene/view_names.h"

namespace ngs::ngs_tool {

namespace fs = std::filesystem;

void record_pictures(const std::string& folder, const std::string& record) {
  nlohmann::json hashes = nlohmann::json::object();
  for (const std::string& name : io::list_images(folder)) hashes[name] = io::content_hash(folder + "/" + name).xxh3;
  io::write_file(record, hashes.dump(1) + "\n");
}

std::vector<std::string> PaintedPictures::all() const {
  std::vector<std::string> names = in_place;
  names.insert(names.end(), other_format.begin(), other_format.end());
  return names;
}

PaintedPictures rescue_painted(const std::string& folder, const std::string& record, const std::string& copies) {
  PaintedPictures painted;
  std::error_code absent;
  if (!fs::exists(record, absent)) return painted;
  const nlohmann::json hashes = io::read_json_file(record);
  std::set<std::string> stems;
  for (const auto& entry : hashes.items()) stems.insert(image_stem(entry.key()));
  for (const std::string& name : io::list_images(folder)) {
    if (!hashes.contains(name))
      (stems.contains(image_stem(name)) ? painted.other_format : painted.unknown).push_back(name);
    else if (io::content_hash((fs::path(folder) / name).generic_string()).xxh3 != hashes.at(name))
      painted.in_place.push_back(name);
  }
  for (const std::string& name : painted.all()) {
    fs::create_directories(copies);
    fs::copy_file(fs::path(folder) / name, fs::path(copies) / name, fs::copy_options::overwrite_existing);
  }
  return painted;
}

std::vector<std::string> strokes_on_copies(const std::vector<std::string>& strokes, const std::string& folder,
                                           const std::string& copies, const PaintedPictures& painted) {
  std::vector<std::string> out;
  std::error_code absent;
  const auto is_folder = [&](const fs::path& path) { return fs::equivalent(path, fs::path(folder) / "", absent); };
  bool all_copies = false;
  for (const std::string& path : strokes) {
    const fs::path copy = fs::path(copies) / fs::path(path).filename();
    if (is_folder(fs::path(path) / "") && fs::exists(copies, absent))
      out.push_back(copies), all_copies = true;
    else
      out.push_back(is_folder(fs::path(path).parent_path() / "") && fs::exists(copy, absent) ? copy.generic_string()
                                                                                             : path);
  }
  for (const std::string& name : painted.all())
    if (const std::string copy = (fs::path(copies) / name).generic_string();
        !all_copies && !std::ranges::count(out, copy))
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

}  // namespace ngs::ngs_tool
