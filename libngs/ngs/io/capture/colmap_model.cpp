#include "ngs/io/capture/colmap_model.h"

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "ngs/core/error.h"
#include "ngs/io/capture/pose.h"

namespace ngs::io {
namespace {

using enum Lens::Kind;

// clang-format off
constexpr std::array kModels{
    ColmapModel{0, "SIMPLE_PINHOLE", 3, 3, kPerspective, ""},
    ColmapModel{1, "PINHOLE", 4, 4, kPerspective, ""},
    ColmapModel{2, "SIMPLE_RADIAL", 4, 3, kPerspective, "r"},
    ColmapModel{3, "RADIAL", 5, 3, kPerspective, "rr"},
    ColmapModel{4, "OPENCV", 8, 4, kPerspective, "rrtt"},
    ColmapModel{5, "OPENCV_FISHEYE", 8, 4, kFisheye, "rrrr"},
    ColmapModel{6, "FULL_OPENCV", 12, 4, kPerspective, "rrttrddd"},
    ColmapModel{7, "FOV", 5, 4, kFov, "f"},
    ColmapModel{8, "SIMPLE_RADIAL_FISHEYE", 4, 3, kFisheye, "r"},
    ColmapModel{9, "RADIAL_FISHEYE", 5, 3, kFisheye, "rr"},
    ColmapModel{10, "THIN_PRISM_FISHEYE", 12, 4, kFisheye, "rrttrrss"},
    ColmapModel{11, "RAD_TAN_THIN_PRISM_FISHEYE", 16, 4, kFisheye, ""},
    ColmapModel{12, "SIMPLE_DIVISION", 4, 3, kPerspective, ""},
    ColmapModel{13, "DIVISION", 5, 4, kPerspective, ""},
    ColmapModel{14, "SIMPLE_FISHEYE", 3, 3, kFisheye, ""},
    ColmapModel{15, "FISHEYE", 4, 4, kFisheye, ""},
    ColmapModel{16, "EUCM", 6, 4, kPerspective, ""},
    ColmapModel{17, "EQUIRECTANGULAR", 2, 0, kPerspective, ""},
};
// clang-format on

bool is_panorama(const ColmapModel& model) { return model.intrinsics == 0; }

/// Whether Lens can represent the distortion parameters of this model.
bool has_lens(const ColmapModel& model) {
  return !is_panorama(model) && int(model.distortion.size()) == model.parameters - model.intrinsics;
}

/// Other projections distort even if all parameters are zero.
bool is_pinhole_without_distortion(const ColmapModel& model) {
  return model.kind == kPerspective && !is_panorama(model);
}

/// `model` null: a model that is not in the list.
std::string way_out(const ColmapModel* model, const std::string& folder) {
  if (model != nullptr && is_panorama(*model)) return kPanoramaRemedy;
  std::string command = undistort_command("IMAGES", folder);
  if (model != nullptr && has_lens(*model))
    command += ", or ngs-scene undistort " + folder + " --images IMAGES -o undistorted";
  return command + "; then import the folder undistorted";
}

[[noreturn]] void refuse(const std::string& found, const ColmapModel* model, const std::string& where,
                         const std::string& folder) {
  throw Error(ErrorCode::kBadInput, where + ": camera model " + found + ", expected a pinhole without distortion",
              way_out(model, folder));
}

/// Lens from the parameters after the intrinsics, in COLMAP's order.
Lens lens_of(const ColmapModel& model, const double* parameter) {
  Lens lens;
  lens.kind = model.kind;
  auto *radial = lens.radial.data(), *tangential = lens.tangential.data(), *divisor = lens.divisor.data(),
       *prism = lens.prism.data();
  for (const char part : model.distortion) {
    double*& place = part == 'r' ? radial : part == 't' ? tangential : part == 'd' ? divisor : prism;
    (part == 'f' ? lens.fov_rad : *place++) = *parameter++;
  }
  return lens;
}

/// The first non-negligible distortion parameter; null: none.
const double* distorting(const ColmapCamera& given) {
  for (auto i = std::size_t(given.model.intrinsics); i < given.parameters.size(); ++i)
    if (!(std::abs(given.parameters[i]) < kNegligibleDistortion)) return &given.parameters[i];
  return nullptr;
}

void refuse_distortion(const ColmapCamera& given, const std::string& where, const std::string& folder) {
  const double* parameter = distorting(given);
  const bool straight = is_pinhole_without_distortion(given.model);
  if (straight && parameter == nullptr) return;
  std::ostringstream found;
  found << given.model.name;
  if (straight) found << " with distortion " << *parameter;
  refuse(found.str(), &given.model, where, folder);
}

void require_lens(const ColmapCamera& given, const std::string& where, const std::string& folder) {
  if (has_lens(given.model) || (!is_panorama(given.model) && distorting(given) == nullptr)) return;
  refuse(given.model.name, &given.model, where, folder);
}

void require_finite(const ColmapCamera& given, const std::string& where) {
  for (const double parameter : given.parameters)
    if (!std::isfinite(parameter))
      throw Error(ErrorCode::kBadInput, where + ": a parameter that is not finite, expected numbers");
  if (given.model.kind == kFov && !(given.parameters[4] > 0 && given.parameters[4] < std::numbers::pi))
    throw Error(ErrorCode::kBadInput, where + ": FOV with an angle that is not between 0 and pi");
}

}  // namespace

const ColmapModel* find_colmap_model_by_id(int id) {
  for (const ColmapModel& model : kModels)
    if (model.id == id) return &model;
  return nullptr;
}

const ColmapModel* find_colmap_model_by_name(const std::string& name) {
  for (const ColmapModel& model : kModels)
    if (model.name == name) return &model;
  return nullptr;
}

std::string undistort_command(const std::string& images, const std::string& folder) {
  return "colmap image_undistorter --image_path " + images + " --input_path " + folder +
         " --output_path undistorted --output_type COLMAP";
}

void refuse_colmap_model(const std::string& model, const std::string& where, const std::string& folder) {
  refuse(model, nullptr, where, folder);
}

ColmapIntrinsics intrinsics_of(const ColmapCamera& given, const std::string& where, const ColmapReading& reading) {
  const auto& [model, width, height, parameters] = given;
  if (reading.distortion == Distortion::kRefused || is_panorama(model))
    refuse_distortion(given, where, reading.folder);
  else {
    require_finite(given, where);
    require_lens(given, where, reading.folder);
  }
  if (width < 1 || height < 1 || width > std::uint64_t(kMaxSide) || height > std::uint64_t(kMaxSide))
    throw Error(ErrorCode::kBadInput, where + ": size " + std::to_string(width) + "x" + std::to_string(height) +
                                          " px, expected 1.." + std::to_string(kMaxSide));
  ColmapIntrinsics found;
  Camera& camera = found.camera;
  camera.width_px = int(width);
  camera.height_px = int(height);
  const bool one_focal = model.intrinsics == 3;
  camera.fx = parameters[0];
  camera.fy = parameters[one_focal ? 0 : 1];
  camera.cx = parameters[one_focal ? 1 : 2];
  camera.cy = parameters[one_focal ? 2 : 3];
  found.lens = lens_of(model, parameters.data() + model.intrinsics);
  return found;
}

void set_intrinsics(const ColmapIntrinsics& from, const std::string& name, Capture& capture, SceneView& view) {
  view.camera = from.camera;
  view.camera.name = name;
  if (has_distortion(from.lens)) capture.lenses[name] = from.lens;
}

}  // namespace ngs::io
