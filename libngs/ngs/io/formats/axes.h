#pragma once
// Formats differ in the directions of their axes. All frames here are that of a PLY (x right, y down, z forward) with
// some axes reversed.
#include <array>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// -1 where the axis of the other frame points the other way, else 1. Applied twice, nothing changes.
using AxisSigns = std::array<float, 3>;

inline constexpr AxisSigns kRightDownForward = {1, 1, 1};
inline constexpr AxisSigns kRightUpBack = {1, -1, -1};    // OpenGL, three.js, SPZ
inline constexpr AxisSigns kLeftUpForward = {-1, -1, 1};  // glTF

/// Position, rotation and spherical harmonics of `row` in the other frame. An odd number of reversed axes mirrors; the
/// mirrored ellipsoid has the rotation R M R, where R reverses the axes and M is the matrix of the rotation.
void reverse_axes(SplatRow& row, const AxisSigns& signs);

}  // namespace ngs::io
