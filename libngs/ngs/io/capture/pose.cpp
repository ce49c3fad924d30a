#include "ngs/io/capture/pose.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ngs/core/error.h"

namespace ngs::io {
namespace {

constexpr double kFileTolerance = 1e-3;  // error of rounding to a few digits

[[noreturn]] void refuse(const std::string& object, const std::string& text, const std::string& remedy = {}) {
  throw Error(ErrorCode::kBadInput, object + ": " + text, remedy);
}

double determinant(const Mat3<double>& m) { return dot(vec3(m.m), cross(vec3(m.m + 3), vec3(m.m + 6))); }

/// max |RᵀR - 1|; NaN if any element is NaN.
double orthonormality_error(const Mat3<double>& m) {
  const Mat3<double> product = transpose(m) * m;
  double worst = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const double error = std::abs(product(r, c) - (r == c ? 1.0 : 0.0));
      if (!(error <= worst)) worst = error;
    }
  return worst;
}

}  // namespace

Mat3<double> rotation_from_quaternion(const double wxyz[4], const std::string& object) {
  const double norm = std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
  if (!(std::abs(norm - 1) <= kFileTolerance))
    refuse(object, "quaternion of length " + std::to_string(norm) + ", expected 1");
  const double w = wxyz[0] / norm, x = wxyz[1] / norm, y = wxyz[2] / norm, z = wxyz[3] / norm;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
           1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
           1 - 2 * (x * x + y * y)}};
}

Mat3<double> checked_rotation(const Mat3<double>& matrix, const std::string& object) {
  const double error = orthonormality_error(matrix);
  if (!(error <= kFileTolerance))
    refuse(object, "3x3 part differs from a rotation by " + std::to_string(error) + ", expected orthonormal axes",
           "a pose with a scale in it: divide the 3x3 part by its scale, keep the translation");
  if (!(determinant(matrix) > 0)) refuse(object, "3x3 part is a reflection (det -1), expected a rotation");
  constexpr double kExact = 1e-14;  // keeps an exact rotation bit for bit
  if (error <= kExact) return matrix;
  using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(Eigen::Map<const Matrix>(matrix.m),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix nearest = svd.matrixU() * svd.matrixV().transpose();
  Mat3<double> out;
  std::copy(nearest.data(), nearest.data() + 9, out.m);
  return out;
}

void set_pose(Camera& camera, const Mat3<double>& axes, Vec3<double> centre) {
  camera.rotation = transpose(axes);
  camera.translation = -1.0 * (camera.rotation * centre);
}

void validate_camera(const Camera& camera, const std::string& object) {
  if (camera.name.empty()) refuse(object, "a view without a name, expected an image name");
  const auto is_control = [](unsigned char c) { return c < 32 || c == 127; };
  if (std::ranges::any_of(camera.name, is_control)) {
    std::string shown = camera.name;
    std::ranges::replace_if(shown, is_control, '?');
    refuse(object,
           "view name '" + shown + "' contains a line end or another control character, expected printable characters");
  }
  const std::string where = object + ": view " + camera.name;
  const std::filesystem::path name(camera.name);
  if (name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end())
    refuse(where, "name leads out of the image folder, expected a relative path without \"..\"");
  if (camera.width_px < 1 || camera.height_px < 1 || camera.width_px > kMaxSide || camera.height_px > kMaxSide)
    refuse(where, "size " + std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px) +
                      " px, expected 1.." + std::to_string(kMaxSide));
  if (!(camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy)))
    refuse(where, "focal length " + std::to_string(camera.fx) + " " + std::to_string(camera.fy) + " px, expected > 0");
  const Vec3<double> t = camera.translation;
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy) || !std::isfinite(t.x) || !std::isfinite(t.y) ||
      !std::isfinite(t.z))
    refuse(where, "non-finite principal point or translation, expected finite numbers");
  constexpr double kTolerance = 1e-6;
  if (!(orthonormality_error(camera.rotation) <= kTolerance && determinant(camera.rotation) > 0))
    refuse(where, "not a rotation matrix, expected orthonormal rows with det +1");
}

}  // namespace ngs::io
