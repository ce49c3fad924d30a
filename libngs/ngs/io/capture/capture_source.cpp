#include "ngs/io/capture/capture_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "ngs/core/error.h"
#include "ngs/core/listed.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/foreign_source.h"
#include "ngs/io/capture/photo_names.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/capture/transforms_json.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/relative_path.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/formats/compression/packed_model.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/io/image/size_rule.h"
#include "ngs/io/scene/find_model.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

constexpr int kLevels = 4;  // of folders below or above a source, searched for cameras
constexpr const char* kKnownFiles[] = {"transforms.json", "transforms_train.json", "cameras.json", "poses_bounds.npy"};

/// The scene's folder: `source` if the model lies below it, else the folder above the "sparse/0", "sparse" or
/// "colmap/sparse/0" of `source`.
std::string base_of_model(const std::string& source, const std::string& model) {
  const fs::path below = fs::path(model).lexically_relative(source);
  if (!below.empty() && (*below.begin() == "sparse" || *below.begin() == "colmap")) return source;
  fs::path base = model, named = (fs::absolute(base) / "").lexically_normal().parent_path();  // resolves "." to a name
  std::error_code ignored;
  for (const char* part : {"0", "sparse", "colmap"}) {
    if (named.filename() != part || fs::is_directory(named / "images", ignored)) continue;
    named = named.parent_path();
    base /= "..";
  }
  base = base.lexically_normal();
  return (base.has_filename() ? base : base.parent_path()).generic_string();
}

struct Located {
  std::string file, base;
  bool colmap = false;
  std::vector<std::string> also;  // other camera files in the same folder
  std::string below = {};         // the folder in the source that has the cameras; empty: the source itself
};

/// Other models next to sparse/0: COLMAP writes one for each part of a capture that it could not connect.
std::vector<std::string> other_models(const std::string& model) {
  const fs::path path(model), above = path.parent_path();
  std::vector<std::string> others;
  if (path.filename() != "0") return others;
  for (const std::string& name : list_folders(above.generic_string()))
    if (const std::string other = (above / name).generic_string();
        name != "0" && name.find_first_not_of("0123456789") == name.npos && find_colmap_model(other) == other)
      others.push_back((above.filename() / name).generic_string());
  return others;
}

Located locate(const std::string& source, bool looks_below = true);

[[noreturn]] void refuse_without_cameras(const std::string& source) {
  for (const char* below : {"colmap", "colmap/sparse", "sparse", "sparse/0"})
    require_readable_folder((fs::path(source) / below).generic_string());
  for (const char* name : {"meta.json", "lod-meta.json"})
    if (const std::string file = (fs::path(source) / name).generic_string(); is_regular_file(file))
      if (const std::string_view kind = sog_kind(read_json_file(file)); !kind.empty()) refuse_unpacked_sog(file, kind);
  const std::string splat = find_model(source).path;
  std::string above = source;
  for (int level = 1; level <= kLevels; ++level) {
    above = (fs::path(above) / ".." / "").lexically_normal().generic_string();
    if (!locate(above, false).file.empty())
      throw Error(ErrorCode::kBadInput, source + ": no cameras found, a folder above has some",
                  "name the folder of the whole capture: ngs cut " + shell_word(above) +
                      (splat.empty() ? "" : "; for its splat without photos: ngs cut " + shell_word(splat)));
  }
  refuse_foreign_folder(source, !splat.empty());
  throw Error(ErrorCode::kBadInput,
              source +
                  ": no cameras found, expected sparse/0 (COLMAP), transforms.json, cameras.json or "
                  "poses_bounds.npy",
              splat.empty() ? "name the file or the folder of the COLMAP model itself; for a splat without photos: "
                              "ngs-scene orbit MODEL -o DIR/scene.json"
                            : "name the file or the folder of the COLMAP model itself; for its splat without photos: "
                              "ngs cut " +
                                  shell_word(splat));
}

Located locate_below(const std::string& source);

Located locate(const std::string& source, bool looks_below) {
  refuse_foreign_file(source);
  if (is_regular_file(source)) {
    const fs::path folder = fs::path(source).parent_path();
    const std::string stem = fs::path(source).stem().string();  // a file of a COLMAP model means its folder
    if ((stem == "cameras" || stem == "images") && fs::path(source).extension() != ".json")
      if (const std::string model = find_colmap_model(folder.empty() ? "." : folder.generic_string()); !model.empty())
        return {model, base_of_model(model, model), true, {}};
    return {source, folder.empty() ? "." : folder.generic_string(), false, {}};
  }
  std::error_code ignored;
  if (!fs::is_directory(source, ignored))
    throw Error(ErrorCode::kBadInput, source + ": no such file or folder, expected cameras");
  if (looks_below) require_readable_folder(source);
  Located found;
  if (const std::string model = find_colmap_model(source); !model.empty())
    found = {model, base_of_model(source, model), true, other_models(model)};
  for (const char* name : kKnownFiles) {
    const std::string file = (fs::path(source) / name).generic_string();
    if (!is_regular_file(file)) continue;
    if (found.file.empty())
      found = {file, source, false, {}};
    else
      found.also.push_back(name);
  }
  if (const std::string scene = (fs::path(source) / "scene.json").generic_string();
      looks_below && found.file.empty() && is_regular_file(scene))
    return {scene, source, false, {}};
  if (found.file.empty() && looks_below) return locate_below(source);
  return found;
}

/// The folders in these folders that can belong to a capture, but results of ngs.
std::vector<std::string> folders_in(const std::vector<std::string>& above) {
  constexpr std::size_t kMost = 1000;
  std::vector<std::string> found;
  for (const std::string& folder : above)
    for (const std::string& name : list_folders(folder)) {
      const fs::path path = fs::path(folder) / name;
      std::error_code ignored;
      if (name.starts_with(".") || fs::is_symlink(path, ignored) || fs::exists(path / ".ngs-cut", ignored)) continue;
      if (found.size() < kMost) found.push_back(path.generic_string());
    }
  return found;
}

/// The cameras of the only folder below `source` that has some, as of a trainer's output folder or an unpacked archive.
/// Folders nearer to the source come first.
Located locate_below(const std::string& source) {
  std::vector<std::string> folders, level{source};
  Located found;
  for (int depth = 0; depth < kLevels && folders.empty(); ++depth) {
    level = folders_in(level);
    for (const std::string& below : level) {
      Located there = locate(below, false);
      if (there.file.empty()) continue;
      folders.push_back(below);
      found = std::move(there);
    }
  }
  if (folders.empty()) refuse_without_cameras(source);
  if (folders.size() > 1)
    throw Error(ErrorCode::kBadInput, source + ": cameras in several folders, expected one: " + listed(folders, 6),
                "name one of these folders");
  found.below = found.base;
  if (find_model(found.base).path.empty()) found.base = source;
  return found;
}

std::string find_images_dir(const CaptureRequest& request, const std::string& base) {
  std::error_code ignored;
  if (!request.images_dir.empty()) {
    if (!fs::is_directory(request.images_dir, ignored))
      throw Error(ErrorCode::kBadInput, request.images_dir + ": no such folder, expected the photos");
    return request.images_dir;
  }
  std::string images = folder_called(base, "images");
  require_readable_folder(images);
  return images;
}

/// Where photos are searched if there is no images/ next to the cameras.
std::vector<std::string> usual_photo_folders(const Located& located, const std::string& source) {
  std::vector<std::string> folders{located.base, located.colmap ? located.file : located.base, source};
  for (const std::string& base : {located.below, located.base, source})
    for (const char* name :
         {"images", "input", "rgb", "photos", "frames", "color", "image", "images_2", "images_4", "images_8"})
      if (!base.empty()) folders.push_back((fs::path(base) / name).generic_string());
  return folders;
}

/// `images`, or the first folder in it that has photos; views take those of the others, such as train/ and test/. Views
/// with folders in their names have them in `images`.
std::string with_photos_or_below(const std::string& images, Capture& capture) {
  for (const SceneView& view : capture.views)
    if (view.camera.name.find('/') != std::string::npos) return images;
  std::vector<std::string> folders{images};
  for (const std::string& name : list_folders(images)) folders.push_back((fs::path(images) / name).generic_string());
  std::string found = folder_with_photos(folders, capture);
  if (found.empty() || found == images) return images;
  for (const std::string& folder : folders)
    for (const FolderIndex index(folder); SceneView & view : capture.views)
      if (std::string photo = index.find(bare_name(view.camera.name)); !is_regular_file(view.image_path))
        view.image_path = std::move(photo);
  return found;
}

/// The photos that a trainer of 3DGS recorded in cfg_args next to its output: Namespace(..., images='images',
/// source_path='/data/garden'). Empty: no such file or key.
std::string photos_of_trainer(const std::string& base) {
  const std::string file = (fs::path(base) / "cfg_args").generic_string();
  if (!is_regular_file(file)) return {};
  const MappedFile mapped = map_regular_file(file);
  const std::string_view text = mapped.text();
  const auto value = [&](const std::string& key) -> std::string {
    const std::size_t at = text.find(key + "='");
    if (at == text.npos) return {};
    const std::size_t begin = at + key.size() + 2;
    const std::string found(text.substr(begin, text.find('\'', begin) - begin));
    return std::ranges::any_of(found, [](unsigned char c) { return c < ' ' || c == 127; }) ? "" : found;
  };
  const std::string source = value("source_path"), images = value("images");
  return source.empty() ? ""
                        : path_from_folder(base, (fs::path(source) / (images.empty() ? "images" : images)).string());
}

/// Replaces the backslashes in image names that were written on Windows, unless a file has this exact name.
void use_slashes(const std::string& images_dir, const std::string& object, Capture& capture) {
  const FolderIndex index(images_dir);
  bool changed = false;
  for (SceneView& view : capture.views) {
    std::string& name = view.camera.name;
    if (name.find('\\') == name.npos || (!images_dir.empty() && !index.find(name).empty())) continue;
    auto lens = capture.lenses.extract(name);
    std::ranges::replace(name, '\\', '/');
    if (!lens.empty()) {
      lens.key() = name;
      capture.lenses.insert(std::move(lens));
    }
    changed = true;
  }
  if (changed) finish_capture(capture, object);
}

bool is_scene(const std::string& file) {
  return fs::path(file).filename() == "scene.json" ||
         (fs::path(file).extension() == ".json" && is_regular_file(file) && read_json_file(file).contains("ngs_scene"));
}

/// Reads the cameras and renders of ngs-scene orbit. A scene of photos is rejected: it is already imported.
void read_rendered_scene(CaptureSource& source) {
  Scene scene = read_scene_json(source.file);
  if (!scene.renders)
    throw Error(ErrorCode::kBadInput, source.file + ": is an imported scene, expected cameras",
                "pass it to the other tools directly, or import the capture that it was made from");
  source.capture = {"scene.json", std::move(scene.views), {}, {}};
  scene.views.clear();
  source.rendered = std::move(scene);
}

Capture read_cameras(const CaptureRequest& request, const Located& located, const std::string& images_dir) {
  if (located.colmap)
    return read_colmap(located.file, request.distortion, [&](Capture capture) {
      const std::string folder =
          images_dir.empty() ? folder_with_photos(usual_photo_folders(located, request.source), capture) : images_dir;
      attach_photos({folder}, capture);
      return std::size_t(
          std::ranges::count_if(capture.views, [](const SceneView& view) { return is_regular_file(view.image_path); }));
    });
  const fs::path file(located.file);
  if (file.extension() == ".npy") {
    if (images_dir.empty())
      throw Error(ErrorCode::kBadInput,
                  located.file + ": no folder of images found, expected one (its order names the poses)",
                  "name it with --images DIR");
    return read_llff(located.file, list_images(images_dir));
  }
  if (file.filename().string().rfind("cameras", 0) == 0) return read_cameras_json(located.file);
  if (file.extension() == ".json") {
    if (const std::string_view kind = sog_kind(read_json_file(located.file)); !kind.empty())
      refuse_unpacked_sog(located.file, kind);
    return read_transforms_json(located.file, request.original_world, request.distortion);
  }
  if (file.extension() == ".ply" || is_model_name(located.file))
    throw Error(ErrorCode::kBadInput, located.file + ": is a splat, expected cameras",
                "with photos: name their cameras, and --ply " + located.file + "; without: ngs-scene orbit " +
                    located.file + " -o DIR/scene.json");
  throw Error(ErrorCode::kBadInput, located.file +
                                        ": unknown kind of file, expected transforms.json, cameras.json, "
                                        "poses_bounds.npy or a COLMAP folder");
}

/// Scales cameras to the sizes of their photos: a folder images_4, or a calibration at another size, is common.
void bring_to_photo_sizes(Capture& capture) {
  std::map<std::string, int> resized_views;
  for (SceneView& view : capture.views) {
    if (view.image_path.empty()) continue;
    const ImageSize photo = read_image_size(view.image_path), camera{view.camera.width_px, view.camera.height_px};
    const SizeRelation relation = relate_sizes(photo, camera, 1);
    if (relation.same) continue;
    if (!relation.allowed)
      throw Error(
          ErrorCode::kInconsistent,
          view.image_path + ": photo of " + to_string(photo) + " px for a camera of " + to_string(camera) +
              " px, expected the same size or the same shape",
          is_turned(photo, camera, 1)
              ? "rotate the photo to match the cameras: ngs ignores EXIF orientation, but the program that"
                " computed the cameras may have applied it (mogrify -auto-orient)"
              : "use the photos that the cameras were calibrated on (undistorted ones for an undistorted model)");
    ++resized_views[to_string(camera) + " px scaled to the photos' " + to_string(photo) + " px"];
    view.camera = resized(view.camera, photo.width_px, photo.height_px);
  }
  for (const auto& [sizes, count] : resized_views)
    capture.notes.push_back(std::to_string(count) + " cameras of " + sizes);
}

}  // namespace

std::string capture_folder(const std::string& source) { return locate(source).base; }

CaptureSource read_capture(const CaptureRequest& request) {
  const Located located = locate(request.source);
  CaptureSource source;
  source.file = located.file;
  source.base = located.base;
  source.images_dir = find_images_dir(request, located.base);
  if (!located.colmap && is_scene(located.file))
    read_rendered_scene(source);
  else
    source.capture = read_cameras(request, located, source.images_dir);
  for (const std::string& other : located.also)
    source.capture.notes.push_back(request.source + ": also holds " + other + ", cameras are read from " +
                                   located.file);
  if (!request.world_transform.empty()) {
    const WorldTransform world = read_world_transform(request.world_transform);
    for (SceneView& view : source.capture.views) apply(world, view.camera);
  }
  use_slashes(source.images_dir, source.file, source.capture);
  if (source.images_dir.empty())
    source.images_dir = folder_with_photos(usual_photo_folders(located, request.source), source.capture);
  else if (request.images_dir.empty())
    source.images_dir = with_photos_or_below(source.images_dir, source.capture);
  std::string recorded;
  if (source.images_dir.empty()) {
    std::error_code ignored;
    recorded = photos_of_trainer(source.base);
    if (fs::is_directory(recorded, ignored)) source.images_dir = recorded;
  }
  attach_photos({source.images_dir, !request.images_dir.empty()}, source.capture);
  if (!recorded.empty())
    source.capture.notes.push_back(recorded + (source.images_dir.empty() ? ": the photos' folder of cfg_args, not here"
                                                                         : ": read for photos, as cfg_args names it"));
  if (!source.rendered) note_unused_photos(source.base, source.capture);
  bring_to_photo_sizes(source.capture);
  return source;
}

Capture llff_capture(const NpyMatrix& poses_bounds, const std::vector<std::string>& image_names,
                     const std::string& object) {
  constexpr std::size_t kColumns = 17;
  if (poses_bounds.columns != kColumns)
    throw Error(ErrorCode::kBadInput, object + ": " + std::to_string(poses_bounds.columns) + " columns, expected 17");
  if (poses_bounds.rows != image_names.size())
    throw Error(ErrorCode::kInconsistent,
                object + ": " + std::to_string(poses_bounds.rows) + " poses, expected one for each of the " +
                    std::to_string(image_names.size()) + " images",
                "name the folder that holds exactly the posed images: --images DIR");
  Capture capture;
  capture.format = "LLFF";
  for (std::size_t i = 0; i < poses_bounds.rows; ++i) {
    const double* row = &poses_bounds.data[i * kColumns];
    const auto at = [&](int r, int c) { return row[r * 5 + c]; };
    const std::string where = object + ": row " + std::to_string(i) + " (" + image_names[i] + ")";
    Camera& camera = capture.views.emplace_back().camera;
    camera.name = image_names[i];
    const double height = at(0, 4), width = at(1, 4);
    if (!(height >= 1 && width >= 1 && height <= double(kMaxSide) && width <= double(kMaxSide)))
      throw Error(ErrorCode::kBadInput, where + ": size " + std::to_string(width) + "x" + std::to_string(height) +
                                            " px, expected 1.." + std::to_string(kMaxSide));
    camera.width_px = int(std::lround(width));
    camera.height_px = int(std::lround(height));
    camera.fx = camera.fy = at(2, 4);
    camera.cx = camera.width_px / 2.0;
    camera.cy = camera.height_px / 2.0;
    Mat3<double> axes;
    for (int r = 0; r < 3; ++r) {
      axes(r, 0) = at(r, 1);
      axes(r, 1) = at(r, 0);
      axes(r, 2) = -at(r, 2);
    }
    set_pose(camera, checked_rotation(axes, where), {at(0, 3), at(1, 3), at(2, 3)});
  }
  capture.notes.push_back(object + ": the format has no principal point, the image centre is assumed");
  finish_capture(capture, object);
  return capture;
}

Capture read_llff(const std::string& path, const std::vector<std::string>& image_names) {
  const MappedFile file = map_regular_file(path);
  return llff_capture(parse_npy(file.bytes(), path), image_names, path);
}

}  // namespace ngs::io
