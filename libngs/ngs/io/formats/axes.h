#pragma once
// Axis conventions of file formats. Every frame here is that of a PLY (x right, y down, z forward) with some axes
// reversed.
#include <array>
#include <functional>

#include "ngs/io/formats/splat_table.h"
#include "ngs/math/vec.h"

namespace ngs::io {

/// Per axis: -1 if the other frame's axis points the other way, else 1. Applying it twice is the identity.
using AxisSigns = std::array<float, 3>;

inline constexpr AxisSigns kRightUpBack = {1, -1, -1};    // OpenGL, three.js, SPZ
inline constexpr AxisSigns kLeftUpForward = {-1, -1, 1};  // glTF

/// Converts position, rotation and spherical harmonics of `row` to the other frame. An odd number of reversed axes is a
/// reflection S; the mirrored ellipsoid has the rotation S M S, where M is the rotation matrix of the row.
void reverse_axes(SplatRow& row, const AxisSigns& signs);

/// Rotates Gaussians about the origin: position, rotation and spherical harmonics.
class RowRotation {
 public:
  /// `rotation`: orthonormal, det +1.
  explicit RowRotation(const Mat3<double>& rotation);
  void apply(SplatRow& row) const;

 private:
  Mat3<double> rotation_;
  std::array<double, 9 + 25 + 49> bands_{};  // per degree 1 to 3: [2 degree + 1, 2 degree + 1], row-major
};

/// The shortest rotation that turns the unit vector `up` to -y, which is up in the frame of a PLY.
Mat3<double> rotation_to_minus_y(Vec3<double> up);

/// Turns a row by it and scales positions and Gaussians by `unit` > 0.
std::function<void(SplatRow&)> placing(Vec3<double> up, double unit);

}  // namespace ngs::io
