#include "ngs/io/formats/splat_table.h"

#include <Eigen/QR>
#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/math/curve_order.h"
#include "ngs/math/elementary.h"
#include "ngs/math/quat.h"
#include "ngs/math/sh.h"
#include "ngs/scene/precision/local_origin.h"

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

constexpr std::size_t kColumnsWithoutRest = 14, kMaxColumns = kColumnsWithoutRest + 45;

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

PlyTable splat_table(std::int64_t count, int sh_degree) {
  std::vector<PlyProperty> properties;
  const auto add = [&](std::string name) { properties.push_back({.name = std::move(name)}); };
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"}) add(name);
  for (int k = 0; k < 3 * sh_rest_count(sh_degree); ++k) add("f_rest_" + std::to_string(k));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) add(name);
  PlyTable table;
  table.set_properties(std::move(properties));
  table.rows = count;
  table.owned.resize(std::size_t(count) * table.row_bytes);
  return table;
}

void store_row(PlyTable& table, std::int64_t i, const SplatRow& row) {
  const std::size_t coefficients = (table.properties.size() - kColumnsWithoutRest) / 3;
  float values[kMaxColumns];
  float* at = std::copy(row.position.begin(), row.position.end(), values);
  at = std::copy(row.sh_dc.begin(), row.sh_dc.end(), at);
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t k = 0; k < coefficients; ++k) *at++ = row.sh_rest[k * 3 + channel];
  *at++ = row.logit_opacity;
  at = std::copy(row.log_scale.begin(), row.log_scale.end(), at);
  std::copy(row.rotation.begin(), row.rotation.end(), at);
  std::memcpy(table.owned.data() + std::size_t(i) * table.row_bytes, values, table.row_bytes);
}

SplatSelection select_rows(const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep) {
  NGS_CHECK(keep.empty() || std::int64_t(keep.size()) == cloud.size(), "keep has one entry per Gaussian");
  SplatSelection selection{cloud, {}, 0, {}, {}};
  if (!needs_local_origin(cloud)) selection.shift = cloud.origin;
  for (std::int64_t i = 0; i < cloud.size(); ++i) {
    if (!keep.empty() && !keep[std::size_t(i)]) continue;
    if (cloud.usable[std::size_t(i)])
      selection.rows.push_back(i);
    else
      ++selection.left_out;
  }
  return selection;
}

SplatRow load_row(const SplatSelection& model, std::int64_t i) {
  const GaussianCloud& cloud = model.cloud;
  const std::size_t r = std::size_t(i), rest = std::size_t(cloud.rest_count()) * 3;
  SplatRow row;
  for (std::size_t a = 0; a < 3; ++a) row.position[a] = float(model.shift[a] + double(cloud.position[r * 3 + a]));
  std::copy_n(&cloud.sh_dc[r * 3], 3, row.sh_dc.begin());
  std::copy_n(cloud.sh_rest.data() + r * rest, rest, row.sh_rest.begin());
  row.logit_opacity = cloud.logit_opacity[r];
  std::copy_n(&cloud.log_scale[r * 3], 3, row.log_scale.begin());
  double length = 0;
  for (std::size_t k = 0; k < 4; ++k) length = portable_hypot(length, double(cloud.rotation[r * 4 + k]));
  for (std::size_t k = 0; k < 4; ++k)
    row.rotation[k] = length > 0 ? float(double(cloud.rotation[r * 4 + k]) / length) : k == 0 ? 1.f : 0.f;
  if (model.turn) model.turn(row);
  return row;
}

SplatSelection along_morton_curve(const SplatSelection& model) {
  std::vector<float> points;
  for (const std::int64_t i : model.rows)
    points.insert(points.end(), &model.cloud.position[std::size_t(i) * 3],
                  &model.cloud.position[std::size_t(i) * 3] + 3);
  SplatSelection sorted{model.cloud, {}, model.left_out, model.shift};
  for (const std::uint32_t k : curve_order(points)) sorted.rows.push_back(model.rows[k]);
  return sorted;
}

}  // namespace ngs::io
