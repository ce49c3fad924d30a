#include "ngs/io/capture/foreign_source.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/os/input_file.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_source(const std::string& source, const std::string& what, const std::string& remedy) {
  throw Error(ErrorCode::kBadInput, source + ": " + what + ", expected a splat or a capture (photos with poses)",
              remedy);
}

/// Two commands that compute poses; COLMAP's folder is then a capture.
std::string colmap_commands(const std::string& photos) {
  const std::string images = shell_word(photos);
  return "compute the poses with COLMAP: mkdir colmap; colmap automatic_reconstructor --dense 0"
         " --workspace_path colmap --image_path " +
         images +
         "; then colmap image_undistorter --input_path colmap/sparse/0 --output_path undistorted"
         " --image_path " +
         images + "; then ngs cut undistorted";
}

struct ForeignKind {
  std::vector<std::string> extensions;
  const char *what, *remedy;
};

const std::vector<ForeignKind>& foreign_kinds() {
  static const std::vector<ForeignKind> kinds = {
      {{".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".insv", ".gif"},
       "a film",
       "extract pictures first: mkdir frames; ffmpeg -i FILE -vf fps=2 frames/%04d.png; then ngs cut frames"},
      {{".blend", ".fbx", ".usdz", ".usd", ".usdc", ".obj", ".stl", ".dae", ".abc", ".3ds", ".max", ".c4d", ".ma",
        ".gltf"},
       "a mesh or a scene of another program",
       "export the splat from that program as PLY; a mesh has no Gaussians to cut"},
      {{".ckpt", ".pt", ".pth"},
       "a checkpoint of a trainer",
       "export its splat as PLY: ns-export gaussian-splat of nerfstudio, the setting save_ply of gsplat"},
      {{".yml", ".yaml"},
       "settings of a trainer",
       "name the folder of the capture that it was trained on, with the exported splat in it or as --model"},
      {{".psx", ".psz", ".rsproj", ".rcproj"},
       "a project of a photogrammetry program",
       "export the cameras as COLMAP, and train a splat on that folder"}};
  return kinds;
}

std::string head_of(const std::string& path) {
  std::string head(4096, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), std::streamsize(head.size()));
  head.resize(std::size_t(in.gcount()));
  return head;
}

void refuse_camera_list(const std::string& file, const std::string& extension) {
  const auto converter = [&](const std::string& program, const std::string& flag) {
    return "convert it with nerfstudio: ns-process-data " + program + " --data PHOTOS --" + flag + " " +
           shell_word(file) + " --output-dir converted; or export the cameras as COLMAP";
  };
  const std::string head = lower_case(head_of(file));
  if (extension == ".xml" && head.find("<document") != head.npos && head.find("<chunk") != head.npos)
    refuse_source(file, "cameras of Metashape", converter("metashape", "xml"));
  if (extension == ".csv" && head.starts_with("#name,") && head.find("heading") != head.npos)
    refuse_source(file, "cameras of RealityScan (RealityCapture)", converter("realitycapture", "csv"));
}

std::vector<std::string> files_of(const std::string& folder, const std::string& extension) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (lower_case(entry.path().extension().string()) == extension)
      names.push_back(entry.path().filename().generic_string());
  std::ranges::sort(names);
  return names;
}

/// "frame_" of "frame_0001.ply"; empty without a number before the extension.
std::string stem_of_number(const std::string& name) {
  const std::string stem = fs::path(name).stem().string();
  const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
  return digits == stem.size() ? "" : stem.substr(0, digits) + "#";
}

void refuse_sequence(const std::string& folder) {
  constexpr std::size_t kFewest = 3;
  const std::vector<std::string> names = files_of(folder, ".ply");
  if (names.size() < kFewest || stem_of_number(names[0]).empty()) return;
  if (std::ranges::any_of(names, [&](const auto& name) { return stem_of_number(name) != stem_of_number(names[0]); }))
    return;
  refuse_source(folder, "a sequence of " + std::to_string(names.size()) + " splats (first: " + names[0] + ")",
                "cut one of them: ngs cut " + shell_word((fs::path(folder) / names[0]).generic_string()));
}

}  // namespace

std::string download_remedy(const std::string& source) {
  return source.find("://") == source.npos ? "" : "download it first: curl -LO " + shell_word(source);
}

void refuse_foreign_file(const std::string& source) {
  const bool is_stdin = source == "-";
  if (is_stdin || os::is_pipe(source))
    refuse_source(
        source, std::string(is_stdin ? "standard input" : "a pipe") + ", which is read only once",
        "save it first: cat " + (is_stdin ? "" : shell_word(source) + " ") + "> model.ply; then ngs cut model.ply");
  if (const std::string remedy = download_remedy(source); !remedy.empty())
    refuse_source(source, "a web address", remedy);
  if (!is_regular_file(source)) return;
  const std::string extension = lower_case(fs::path(source).extension().string());
  for (const ForeignKind& kind : foreign_kinds())
    if (std::ranges::find(kind.extensions, extension) != kind.extensions.end()) {
      std::string remedy = kind.remedy;
      if (const std::size_t at = remedy.find("FILE"); at != remedy.npos) remedy.replace(at, 4, shell_word(source));
      refuse_source(source, kind.what, remedy);
    }
  if (has_image_extension(source) || has_unread_extension(source))
    refuse_source(source, "a picture",
                  "give the splat, or the folder of all photos with their poses; a picture with strokes "
                  "goes to --strokes");
  refuse_camera_list(source, extension);
}

void refuse_foreign_folder(const std::string& folder, bool has_splat) {
  std::error_code ignored;
  const fs::path path(folder);
  for (const char* keyframes : {"keyframes", "."})
    for (const char* cameras : {"corrected_cameras", "cameras"})
      if (fs::is_directory(path / keyframes / cameras, ignored) &&
          !files_of((path / keyframes / cameras).string(), ".json").empty())
        refuse_source(folder, "a raw scan of Polycam",
                      "convert it with nerfstudio: ns-process-data polycam --data " + shell_word(folder) +
                          " --output-dir converted; then train a splat on the folder converted");
  for (const char* extension : {".xml", ".csv"})
    for (const std::string& name : files_of(folder, extension))
      refuse_camera_list((path / name).generic_string(), extension);
  if (has_splat) return;
  refuse_sequence(folder);
  std::vector<std::string> places{folder};
  for (const std::string& name : list_folders(folder))
    if (lower_case(name).find("mask") == std::string::npos) places.push_back((path / name).generic_string());
  for (const std::string& place : places)
    if (const std::vector<std::string> images = list_images(place); images.size() > 1)
      refuse_source(
          folder,
          std::to_string(images.size()) + " photos" + (place == folder ? "" : " in " + place) + " without poses",
          colmap_commands(place));
}

}  // namespace ngs::io
