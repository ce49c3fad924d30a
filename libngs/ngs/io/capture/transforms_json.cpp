#include "ngs/io/capture/transforms_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>

#include "ngs/core/error.h"
#include "ngs/core/listed.h"
#include "ngs/io/capture/colmap_model.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/files/relative_path.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Intrinsics of a frame, falling back to those of the file.
class Lookup {
 public:
  Lookup(const JsonReader& frame, const JsonReader& file) : frame_(frame), file_(file) {}
  const JsonReader* holder(const std::string& key) const {
    return frame_.has(key) ? &frame_ : file_.has(key) ? &file_ : nullptr;
  }
  std::optional<double> number(const std::string& key) const {
    const JsonReader* reader = holder(key);
    return reader != nullptr ? std::optional(reader->number(key)) : std::nullopt;
  }

 private:
  const JsonReader &frame_, &file_;
};

std::string undistort_remedy() {
  return "undistort the photos, e.g. with " + undistort_command("images", "colmap/sparse/0") +
         ", or ngs-scene undistort FILE -o undistorted; then import the folder undistorted";
}

void refuse_distortion(const Lookup& lookup, const std::string& where) {
  for (const char* key : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"}) {
    const double value = lookup.number(key).value_or(0);
    if (std::abs(value) >= kNegligibleDistortion)
      throw Error(ErrorCode::kBadInput,
                  where + ": lens distortion " + key + " = " + json(value).dump() + ", expected none",
                  undistort_remedy());
  }
}

std::string camera_model(const Lookup& lookup) {
  const JsonReader* reader = lookup.holder("camera_model");
  return reader == nullptr ? "OPENCV" : reader->text("camera_model");
}

/// instant-ngp's flag; the lens distorts even if k1..k4 are zero.
bool has_fisheye_flag(const Lookup& lookup) {
  const JsonReader* flag = lookup.holder("is_fisheye");
  return flag != nullptr && flag->boolean("is_fisheye");
}

/// nerfstudio's names of 360-degree images, mono or stereo.
bool is_panorama(const std::string& model) {
  return model == "EQUIRECTANGULAR" || model == "SPHERICAL" || model.starts_with("OMNIDIRECTIONAL") ||
         model.starts_with("VR180");
}

/// kBadInput for models that are neither a pinhole nor a supported lens.
void require_known_model(const Lookup& lookup, const std::string& where, Distortion distortion) {
  const bool keeps_distortion = distortion == Distortion::kKept;
  if (!keeps_distortion && has_fisheye_flag(lookup))
    throw Error(ErrorCode::kBadInput, where + ": is_fisheye, expected a pinhole", undistort_remedy());
  const std::string model = camera_model(lookup);
  constexpr std::array kPerspectiveModels{"PINHOLE",       "SIMPLE_PINHOLE", "OPENCV",
                                          "SIMPLE_RADIAL", "RADIAL",         "FULL_OPENCV"};
  if (keeps_distortion && model == "OPENCV_FISHEYE") return;
  if (std::ranges::find(kPerspectiveModels, model) != kPerspectiveModels.end()) return;
  throw Error(ErrorCode::kBadInput, where + ": camera model " + model + ", expected a pinhole",
              is_panorama(model)          ? kPanoramaRemedy
              : model == "OPENCV_FISHEYE" ? undistort_remedy()
                                          : "export pinhole photos with the program that made the file");
}

Lens lens_of(const Lookup& lookup, const std::string& where) {
  const auto of = [&](const char* key) { return lookup.number(key).value_or(0); };
  Lens lens;
  if (camera_model(lookup) == "OPENCV_FISHEYE" || has_fisheye_flag(lookup)) lens.kind = Lens::Kind::kFisheye;
  lens.radial = {of("k1"), of("k2"), of("k3"), of("k4")};
  lens.tangential = {of("p1"), of("p2")};
  if (camera_model(lookup) == "FULL_OPENCV") {
    lens.radial[3] = 0;
    lens.divisor = {of("k4"), of("k5"), of("k6")};
  } else if (of("k5") != 0 || of("k6") != 0)
    throw Error(ErrorCode::kBadInput,
                where + ": k5 or k6 with camera_model " + camera_model(lookup) + ", expected FULL_OPENCV with them");
  return lens;
}

/// Resolves a path of the file. Backslashes (of Windows) become slashes, unless a file with that exact name exists.
std::string path_in(const TransformsSource& source, std::string text) {
  const std::string folder = source.folder.empty() ? "." : source.folder;
  if (text.find('\\') != std::string::npos && !source.images.exists(path_from_folder(folder, text)))
    std::replace(text.begin(), text.end(), '\\', '/');
  return path_from_folder(folder, text);
}

std::string find_image(const TransformsSource& source, const std::string& file_path) {
  std::string path = path_in(source, file_path);
  if (source.images.exists(path)) return path;
  for (const char* extension : {".png", ".jpg", ".jpeg", ".JPG", ".PNG"})
    if (source.images.exists(path + extension)) return path + extension;
  return fs::path(path).has_extension() ? path : path + ".png";
}

bool has_size(const Lookup& lookup) { return lookup.holder("w") != nullptr && lookup.holder("h") != nullptr; }

/// The size of the images of those frames that state no size, if it is the same for all that are there.
std::optional<ImageSize> common_image_size(const JsonReader& file, const TransformsSource& source) {
  std::optional<ImageSize> common;
  std::size_t index = 0;
  for (const json& entry : file.array("frames")) {
    const JsonReader frame(entry, source.object + ": frames[" + std::to_string(index++) + "]");
    if (has_size(Lookup(frame, file))) continue;
    const std::string image = find_image(source, frame.text("file_path"));
    if (!source.images.exists(image)) continue;
    const ImageSize size = source.images.size(image);
    if (common && !(*common == size)) return std::nullopt;
    common = size;
  }
  return common;
}

/// The size of the camera: stated, of its image, or `common`. nullopt: none of these.
std::optional<ImageSize> camera_size(const Lookup& lookup, const TransformsSource& source,
                                     const std::string& image_path, const std::optional<ImageSize>& common) {
  if (has_size(lookup))
    return ImageSize{int(lookup.holder("w")->integer("w", 1, kMaxSide)),
                     int(lookup.holder("h")->integer("h", 1, kMaxSide))};
  return source.images.exists(image_path) ? source.images.size(image_path) : common;
}

void read_intrinsics(const Lookup& lookup, const std::string& where, ImageSize size, Camera& camera) {
  camera.width_px = size.width_px;
  camera.height_px = size.height_px;
  const auto focal_of = [&](const char* focal, const char* angle, int size_px) -> std::optional<double> {
    if (const auto value = lookup.number(focal)) return value;
    const auto value = lookup.number(angle);
    if (!value) return std::nullopt;
    if (!(*value > 0 && *value < std::numbers::pi)) lookup.holder(angle)->fail(angle, "an angle between 0 and pi");
    return size_px / (2 * std::tan(*value / 2));
  };
  const auto fx = focal_of("fl_x", "camera_angle_x", camera.width_px);
  const auto fy = focal_of("fl_y", "camera_angle_y", camera.height_px);
  if (!fx && !fy) throw Error(ErrorCode::kBadInput, where + ": no focal length, expected fl_x or camera_angle_x");
  camera.fx = fx.value_or(fy.value_or(0));
  camera.fy = fy.value_or(fx.value_or(0));
  camera.cx = lookup.number("cx").value_or(camera.width_px / 2.0);
  camera.cy = lookup.number("cy").value_or(camera.height_px / 2.0);
}

struct RigidRows {  // [rotation | translation]
  Mat3<double> rotation;
  Vec3<double> translation;
};

RigidRows rigid_from(const std::vector<double>& rows, const std::string& where) {
  const Mat3<double> m{{rows[0], rows[1], rows[2], rows[4], rows[5], rows[6], rows[8], rows[9], rows[10]}};
  return {checked_rotation(m, where), {rows[3], rows[7], rows[11]}};
}

RigidRows read_rigid(const JsonReader& reader, const std::string& key) {
  const std::size_t rows = reader.array(key).size() == 3 ? 3 : 4;
  const std::vector<double> m = reader.matrix(key, rows, 4);
  const bool affine = rows == 3 || (m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1);
  if (!affine) reader.fail(key, "a last row of 0 0 0 1");
  return rigid_from(m, reader.where() + "." + key);
}

double positive_scale(const JsonReader& reader, const std::string& key) {
  const double scale = reader.number_or(key, 1);
  if (!(scale > 0)) reader.fail(key, "a number > 0");
  return scale;
}

/// The file has x' = scale · (A x + b) with x in the original world; returns the inverse similarity.
std::optional<WorldTransform> undo_applied(const JsonReader& file) {
  if (!file.has("applied_transform")) return std::nullopt;
  const RigidRows applied = read_rigid(file, "applied_transform");
  const double scale = positive_scale(file, "applied_scale");
  // x = Aᵀ (x' / scale - b) = 1/scale · (Aᵀ x' - scale Aᵀ b)
  const Mat3<double> inverse = transpose(applied.rotation);
  return WorldTransform{inverse, (-scale) * (inverse * applied.translation), 1 / scale};
}

/// Sets view names: paths relative to the deepest folder that contains all images. All paths are made absolute first,
/// because some may be absolute and others relative; they then share at least the root.
void name_views(Capture& capture) {
  std::vector<fs::path> files;
  for (const SceneView& view : capture.views) files.push_back(fs::absolute(view.image_path).lexically_normal());
  fs::path shared = files.front().parent_path();
  for (const fs::path& file : files)
    while (std::mismatch(shared.begin(), shared.end(), file.begin(), file.end()).first != shared.end())
      shared = shared.parent_path();
  for (std::size_t i = 0; i < files.size(); ++i)
    capture.views[i].camera.name = files[i].lexically_relative(shared).generic_string();
}

/// Notes frames without w, h and image. kBadInput if no frame is left.
void note_lost_images(const TransformsSource& source, const std::vector<std::string>& assumed_size,
                      const std::vector<std::string>& without_size, Capture& capture) {
  if (capture.views.empty() && !without_size.empty())
    throw Error(ErrorCode::kBadInput,
                source.object + ": no w and h and no image " + without_size[0] + ", expected a size",
                "add \"w\" and \"h\" to the file, or put the images at their file_path");
  if (!assumed_size.empty())
    capture.notes.push_back(source.object +
                            ": no w and h for images that are not there: the size of the others is used (" +
                            listed(assumed_size, 3) + ")");
  if (!without_size.empty())
    capture.notes.push_back(source.object +
                            ": frames without w, h and image are left out, the other images differ in size (" +
                            listed(without_size, 3) + ")");
}

}  // namespace

Capture parse_transforms_json(const json& root, const TransformsSource& source) {
  const JsonReader file(root, source.object);
  Capture capture;
  capture.format = "transforms.json";
  std::vector<Lens> lenses;  // of the views
  const std::optional<ImageSize> common = common_image_size(file, source);
  std::vector<std::string> without_size, assumed_size;  // images that are not there
  std::size_t index = 0;
  for (const json& entry : file.array("frames")) {
    const JsonReader frame(entry, source.object + ": frames[" + std::to_string(index++) + "]");
    const Lookup lookup(frame, file);
    require_known_model(lookup, frame.where(), source.distortion);
    if (source.distortion == Distortion::kRefused) refuse_distortion(lookup, frame.where());
    SceneView view;
    view.image_path = find_image(source, frame.text("file_path"));
    if (frame.has("mask_path")) view.mask_path = path_in(source, frame.text("mask_path"));
    const std::optional<ImageSize> size = camera_size(lookup, source, view.image_path, common);
    if (!size || (!has_size(lookup) && !source.images.exists(view.image_path)))
      (size ? assumed_size : without_size).push_back(view.image_path);
    if (!size) continue;
    read_intrinsics(lookup, frame.where(), *size, view.camera);
    const RigidRows pose = read_rigid(frame, "transform_matrix");
    Mat3<double> axes = pose.rotation;  // OpenGL -> ours: y and z change sign
    for (int r = 0; r < 3; ++r) {
      axes(r, 1) = -axes(r, 1);
      axes(r, 2) = -axes(r, 2);
    }
    set_pose(view.camera, axes, pose.translation);
    capture.views.push_back(std::move(view));
    lenses.push_back(lens_of(lookup, frame.where()));
  }
  note_lost_images(source, assumed_size, without_size, capture);
  if (!capture.views.empty()) name_views(capture);
  for (std::size_t v = 0; v < lenses.size(); ++v)
    if (has_distortion(lenses[v])) capture.lenses[capture.views[v].camera.name] = lenses[v];
  if (const auto undo = undo_applied(file)) {
    if (source.original_world)
      for (SceneView& view : capture.views) apply(*undo, view.camera);
    capture.notes.push_back(
        source.object + (source.original_world ? ": applied_transform undone"
                                               : ": poses kept in the file's own world (it has an applied_transform)"));
  }
  finish_capture(capture, source.object);
  return capture;
}

Capture read_transforms_json(const std::string& path, bool original_world, Distortion distortion) {
  return parse_transforms_json(read_json_file(path), {fs::path(path).parent_path().generic_string(), path,
                                                      original_world, images_on_disk(), distortion});
}

WorldTransform read_world_transform(const std::string& path) {
  const json root = read_json_file(path);
  const JsonReader reader(root, path);
  const RigidRows rigid = read_rigid(reader, "transform");
  return {rigid.rotation, rigid.translation, positive_scale(reader, "scale")};
}

void apply(const WorldTransform& world, Camera& camera) {
  const Mat3<double> axes = world.rotation * transpose(camera.rotation);
  set_pose(camera, axes, world.scale * (world.rotation * camera.centre() + world.translation));
}

Capture parse_cameras_json(const nlohmann::json& root, const std::string& object) {
  if (!root.is_array())
    throw Error(ErrorCode::kBadInput, object + ": " + root.type_name() + ", expected a list of cameras");
  Capture capture;
  capture.format = "cameras.json";
  bool assumes_centre = false;  // some entry has no principal point
  for (const nlohmann::json& entry : root) {
    const JsonReader reader(entry, object + ": [" + std::to_string(capture.views.size()) + "]");
    Camera& camera = capture.views.emplace_back().camera;
    camera.name = reader.text("img_name");
    camera.width_px = int(reader.integer("width", 1, kMaxSide));
    camera.height_px = int(reader.integer("height", 1, kMaxSide));
    camera.fx = reader.number("fx");
    camera.fy = reader.number("fy");
    assumes_centre |= !reader.has("cx") || !reader.has("cy");
    camera.cx = reader.number_or("cx", camera.width_px / 2.0);
    camera.cy = reader.number_or("cy", camera.height_px / 2.0);
    const std::vector<double> rows = reader.matrix("rotation", 3, 3), centre = reader.matrix("position", 3, 0);
    Mat3<double> axes;
    std::copy(rows.begin(), rows.end(), axes.m);
    set_pose(camera, checked_rotation(axes, reader.where() + ".rotation"), vec3(centre.data()));
  }
  if (assumes_centre)
    capture.notes.push_back(object + ": the format has no principal point, the image centre is assumed");
  finish_capture(capture, object);
  return capture;
}

Capture read_cameras_json(const std::string& path) { return parse_cameras_json(read_json_file(path), path); }

}  // namespace ngs::io
