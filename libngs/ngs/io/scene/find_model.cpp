#include "ngs/io/scene/find_model.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/core/listed.h"
#include "ngs/core/parse_number.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/io/ply/gaussian_columns.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

enum class FileKind : std::uint8_t {
  kSplat,
  kOtherFormat,
  kUnreadable,
  kNoSplat
};  // a splat as PLY, in another format

struct Candidate {
  std::string path, what;
  FileKind kind;
};

Candidate look_at_ply(const std::string& path) {
  try {
    const PlyFile file = PlyFile::header_of(path);
    const PlyElement* vertex = file.find("vertex");
    const std::string count = std::to_string(vertex == nullptr ? 0 : vertex->count);
    if (vertex != nullptr && is_gaussian_element(*vertex))
      return {path, "a splat of " + count + " Gaussians", FileKind::kSplat};
    const PlyElement* face = file.find("face");
    if (face != nullptr && face->count > 0) return {path, "a mesh of " + count + " vertices", FileKind::kNoSplat};
    return {path, "a point cloud of " + count + " points", FileKind::kNoSplat};
  } catch (const Error&) {
    return {path, "a damaged PLY", FileKind::kUnreadable};
  }
}

/// Whether a .glb mentions splats near its beginning; the others hold meshes.
bool holds_splats(const std::string& glb) {
  std::string head(std::size_t(1) << 20, '\0');
  std::ifstream in(glb, std::ios::binary);
  in.read(head.data(), std::streamsize(head.size()));
  return std::string_view(head.data(), std::size_t(in.gcount())).find("KHR_gaussian_splatting") != std::string::npos;
}

/// The files of the folder with names of models, sorted.
std::vector<Candidate> candidates_in(const fs::path& folder) {
  std::vector<std::string> paths;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = lower_case(entry.path().filename().string());
    const bool is_model =
        name.ends_with(".ply") || name.ends_with(".ply.gz") || name.ends_with(".zip") || is_model_name(name);
    if (is_model && !is_resource_fork(name) && is_regular_file(entry.path().generic_string()))
      paths.push_back(entry.path().generic_string());
  }
  std::ranges::sort(paths);
  std::vector<Candidate> found;
  for (const std::string& path : paths)
    if (lower_case(path).ends_with(".glb") && !holds_splats(path))
      found.push_back({path, "a .glb without splats", FileKind::kNoSplat});
    else if (lower_case(path).ends_with(".zip"))
      found.push_back({path, "a zip archive", FileKind::kNoSplat});
    else if (lower_case(path).ends_with(".ply"))
      found.push_back(look_at_ply(path));
    else
      found.push_back({path, "a splat", FileKind::kOtherFormat});
  return found;
}

/// The newest point_cloud/iteration_N/point_cloud.ply of a trainer's output folder. `others`: the older ones.
std::string newest_iteration(const fs::path& base, std::vector<Candidate>& others) {
  std::uint32_t newest = 0;
  std::string path;
  for (const std::string& name : list_folders((base / "point_cloud").generic_string())) {
    std::uint32_t iteration = 0;
    const std::string file = (base / "point_cloud" / name / "point_cloud.ply").generic_string();
    if (name.rfind("iteration_", 0) != 0 || !parse_number(name.substr(10), iteration) || !is_regular_file(file))
      continue;
    const bool is_newest = path.empty() || iteration > newest;
    if (const std::string older = is_newest ? path : file; !older.empty()) others.push_back(look_at_ply(older));
    if (is_newest) {
      newest = iteration;
      path = file;
    }
  }
  return path;
}

/// Whether a folder contains results of ngs: splats in it are outputs, not inputs.
bool holds_results(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / ".ngs-cut", ignored) || fs::exists(folder / "scene.json", ignored);
}

void add_below(const fs::path& folder, int levels, std::vector<Candidate>& found) {
  for (const std::string& name : list_folders(folder.generic_string())) {
    const fs::path below = folder / name;
    if (name.starts_with(".") || holds_results(below)) continue;
    std::vector<Candidate> there = candidates_in(below), older;
    const std::string newest = newest_iteration(below, older);
    if (!newest.empty()) there.push_back(look_at_ply(newest));
    for (Candidate& candidate : there)
      if (candidate.kind != FileKind::kUnreadable) found.push_back(std::move(candidate));
    if (levels > 1 && newest.empty()) add_below(below, levels - 1, found);
  }
}

std::vector<Candidate> of_kind(const std::vector<Candidate>& all, FileKind kind) {
  std::vector<Candidate> some;
  std::ranges::copy_if(all, std::back_inserter(some), [&](const Candidate& c) { return c.kind == kind; });
  return some;
}

std::string listed(const std::vector<Candidate>& files) {
  std::vector<std::string> names;
  for (const Candidate& file : files) names.push_back(file.path + " (" + file.what + ")");
  return ngs::listed(names, 6);
}

/// The only file of the most preferred kind that occurs.
ModelSearch only_splat(const std::string& folder, const std::vector<Candidate>& files) {
  for (const FileKind kind : {FileKind::kSplat, FileKind::kOtherFormat, FileKind::kUnreadable}) {
    const std::vector<Candidate> some = of_kind(files, kind);
    if (some.size() == 1) return {some[0].path, {}, {}};
    if (some.size() > 1) return {{}, folder + ": several splats, none chosen: " + listed(some), {}};
  }
  return {{}, folder + ": no splat found" + (files.empty() ? "" : " among " + listed(files)), {}};
}

}  // namespace

ModelSearch find_model(const std::string& folder) {
  std::vector<Candidate> files = candidates_in(folder);
  ModelSearch found;
  for (const char* name : {"point_cloud.ply", "model.ply"})
    for (const Candidate& file : files)
      if (found.path.empty() && fs::path(file.path).filename() == name && file.kind != FileKind::kNoSplat)
        found.path = file.path;
  std::vector<Candidate> older;
  if (found.path.empty()) found.path = newest_iteration(folder, older);
  if (!found.path.empty()) {
    files.insert(files.end(), older.begin(), older.end());
    std::vector<Candidate> others = of_kind(files, FileKind::kSplat);
    std::erase_if(others, [&](const Candidate& file) { return file.path == found.path; });
    if (!others.empty()) found.unused = found.path + " is the model, not " + listed(others);
    return found;
  }
  if (std::ranges::all_of(files, [](const Candidate& file) { return file.kind == FileKind::kNoSplat; }))
    add_below(folder, 3, files);
  return only_splat(folder, files);
}

std::string find_world_transform(const std::string& folder) {
  constexpr int kMaxDepth = 5;
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder.empty() ? "." : folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    if (entry.depth() >= kMaxDepth) entry.disable_recursion_pending();
    if (entry->path().filename() == "dataparser_transforms.json") return entry->path().generic_string();
  }
  return {};
}

std::string antialiasing_settings(const std::string& model) {
  constexpr std::size_t kMaxLevels = 3;
  fs::path folder = fs::path(model).parent_path();
  for (std::size_t level = 0; level < kMaxLevels; ++level) {
    for (const char* name : {"cfg_args", "cfg.yml", "config.yml"}) {
      std::string file = (folder / name).generic_string();
      if (!is_regular_file(file)) continue;
      const MappedFile mapped = map_regular_file(file);
      for (const char* words : {"antialiasing=True", "antialiased: true", "rasterize_mode: antialiased"})
        if (mapped.text().find(words) != std::string_view::npos) return file;
    }
    const std::string name = folder.filename().string();
    const bool is_of_trainer = name.starts_with("iteration_") || name == "point_cloud" || name == "ply";
    if (!is_of_trainer) return {};
    folder = folder.parent_path();
  }
  return {};
}

}  // namespace ngs::io
