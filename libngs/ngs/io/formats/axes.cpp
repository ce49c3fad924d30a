#include "ngs/io/formats/axes.h"

#include <Eigen/QR>

#include "ngs/math/quat.h"
#include "ngs/math/sh.h"

namespace ngs::io {
namespace {

/// Whether the basis function of each coefficient is odd in x, y and z. Degree 1: y z x; degree 2: xy yz zz xz xx-yy;
/// degree 3: y(3xx-yy) xyz y(4zz-..) z(2zz-..) x(4zz-..) z(xx-yy) x(xx-3yy).
struct Parity {
  bool x, y, z;
};
constexpr Parity kOdd[15] = {{false, true, false}, {false, false, true},  {true, false, false}, {true, true, false},
                             {false, true, true},  {false, false, false}, {true, false, true},  {false, false, false},
                             {false, true, false}, {true, true, true},    {false, true, false}, {false, false, true},
                             {true, false, false}, {false, false, true},  {true, false, false}};

}  // namespace

void reverse_axes(SplatRow& row, const AxisSigns& signs) {
  for (std::size_t a = 0; a < 3; ++a) row.position[a] *= signs[a];
  // The axis of a rotation is a pseudovector: its x changes sign with y and z.
  row.rotation[1] *= signs[1] * signs[2];
  row.rotation[2] *= signs[0] * signs[2];
  row.rotation[3] *= signs[0] * signs[1];
  for (std::size_t k = 0; k < 15; ++k) {
    const float sign = (kOdd[k].x ? signs[0] : 1) * (kOdd[k].y ? signs[1] : 1) * (kOdd[k].z ? signs[2] : 1);
    for (std::size_t c = 0; c < 3; ++c) row.sh_rest[k * 3 + c] *= sign;
  }
}

RowRotation::RowRotation(const Mat3<double>& rotation) : rotation_(rotation) {
  constexpr int kDirections = 64;  // far more than the 7 coefficients of a band
  Eigen::MatrixXd basis(kDirections, 15), turned(kDirections, 15);
  for (int i = 0; i < kDirections; ++i) {  // a spiral over the sphere
    const double z = 1 - (2 * i + 1.0) / kDirections, radius = std::sqrt(1 - z * z), angle = 2.4 * i;
    const Vec3<double> d{radius * std::cos(angle), radius * std::sin(angle), z};
    double values[15];
    sh_rest_basis(3, d, values);
    for (int k = 0; k < 15; ++k) basis(i, k) = values[k];
    sh_rest_basis(3, transpose(rotation) * d, values);
    for (int k = 0; k < 15; ++k) turned(i, k) = values[k];
  }
  // The rotated function at d is the function at the inverse rotation of d: basis * band = turned.
  double* to = bands_.data();
  for (int degree = 1; degree <= 3; ++degree) {
    const int first = degree * degree - 1, size = 2 * degree + 1;
    const Eigen::MatrixXd band =
        basis.middleCols(first, size).colPivHouseholderQr().solve(turned.middleCols(first, size));
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size; ++c) *to++ = band(r, c);
  }
}

void RowRotation::apply(SplatRow& row) const {
  const Vec3<double> p = rotation_ * Vec3<double>{row.position[0], row.position[1], row.position[2]};
  row.position = {float(p.x), float(p.y), float(p.z)};
  row.rotation = stored_quaternion(rotation_ * axes_of_quaternion(row.rotation.data()));
  const std::array<float, 45> before = row.sh_rest;
  const double* band = bands_.data();
  for (std::size_t degree = 1; degree <= 3; ++degree) {
    const std::size_t first = degree * degree - 1, size = 2 * degree + 1;
    for (std::size_t k = 0; k < size; ++k, band += size)
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t j = 0; j < size; ++j) sum += band[j] * double(before[(first + j) * 3 + c]);
        row.sh_rest[(first + k) * 3 + c] = float(sum);
      }
  }
}

Mat3<double> rotation_to_minus_y(Vec3<double> up) {
  if (up.y > 1 - 1e-12) return {{1, 0, 0, 0, -1, 0, 0, 0, -1}};  // by 180 degrees about x
  const Vec3<double> axis = cross(up, Vec3<double>{0, -1, 0});
  double unused = 0;
  return rotation_matrix(normalised(Vec4<double>{1 - up.y, axis.x, axis.y, axis.z}, unused));
}

std::function<void(SplatRow&)> placing(Vec3<double> up, double unit) {
  return [rotation = RowRotation(rotation_to_minus_y(up)), unit](SplatRow& row) {
    rotation.apply(row);
    for (float& x : row.position) x = float(unit * double(x));
    for (float& x : row.log_scale) x = float(double(x) + std::log(unit));
  };
}

}  // namespace ngs::io
