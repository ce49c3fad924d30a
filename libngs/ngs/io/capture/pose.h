#pragma once
// Checks and conversions shared by all camera readers.
#include <cstdint>
#include <string>

#include "ngs/scene/camera.h"

namespace ngs::io {

inline constexpr std::int64_t kMaxSide = 1 << 16;  // px

/// Unit quaternion w x y z -> rotation matrix. Accepts | |q| - 1 | <= 1e-3 (files with few digits) and normalises.
/// kBadInput, with `object` in the message, for anything else, zero and NaN included.
Mat3<double> rotation_from_quaternion(const double wxyz[4], const std::string& object);

/// Returns the rotation nearest to `matrix`. Accepts |RᵀR - 1| <= 1e-3 per element and det > 0. kBadInput, with
/// `object` in the message, for anything else (reflections, scaled or NaN matrices).
Mat3<double> checked_rotation(const Mat3<double>& matrix, const std::string& object);

/// The world -> camera pose of the camera whose axes in the world are the columns of `axes` (x right, y down,
/// z forward) and whose centre is `centre`: R = axesᵀ, t = -R centre.
void set_pose(Camera& camera, const Mat3<double>& axes, Vec3<double> centre);

/// kBadInput unless size, focal lengths, principal point and pose are finite and in range, the rotation is orthonormal
/// with det +1 (tolerance 1e-6) and the name is not empty.
void validate_camera(const Camera& camera, const std::string& object);

}  // namespace ngs::io
