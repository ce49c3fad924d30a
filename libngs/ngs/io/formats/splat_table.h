#pragma once
// Gaussians in the encoding and frame of a PLY (x right, y down, z forward): the output of all readers but PLY, and the
// input of their writers.
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/ply_types.h"
#include "ngs/math/vec.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::io {

struct SplatRow {
  std::array<float, 3> position{};  // world
  std::array<float, 3> sh_dc{};     // rgb = colour_of_dc(sh_dc), math/sh.h
  std::array<float, 45> sh_rest{};  // [coefficient · 3 + channel]; the first 3 · sh_rest_count(degree) are used
  float logit_opacity = 0;
  std::array<float, 3> log_scale{};
  std::array<float, 4> rotation{};  // w x y z
};

struct DecodedSplat {
  PlyTable rows;                   // x y z f_dc_* f_rest_* opacity scale_* rot_*, all float, packed
  bool antialiased = false;        // flag of the file: trained with Mip-Splatting's opacity compensation
  std::vector<std::string> notes;  // warnings for the user, one sentence each
};

/// Allocates a table for `count` Gaussians. Callers must have checked `count` against the file size.
PlyTable splat_table(std::int64_t count, int sh_degree);

void store_row(PlyTable& table, std::int64_t i, const SplatRow& row);

/// The rows of a model that are written. Quantised formats cannot store non-finite values: unusable rows
/// (GaussianCloud::usable) are left out.
struct SplatSelection {
  const GaussianCloud& cloud;
  std::vector<std::int64_t> rows;
  std::int64_t left_out = 0;
  std::array<double, 3> shift{};             // added to positions: the cloud's origin, or 0 if needs_local_origin()
  std::function<void(SplatRow&)> turn = {};  // applied to every row; empty: none
};

/// Positions whose rounding error in a format exceeds the usual size of a Gaussian (usual_size()).
struct Rounding {
  std::int64_t rows = 0;      // number of such rows
  double step = 0;            // the widest step, world
  std::int64_t farthest = 0;  // the row of the cloud that causes the widest step,
  double coordinate = 0;      // and its largest coordinate
};

/// Rows with keep[i] != 0; an empty `keep` selects all.
SplatSelection select_rows(const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep);

/// Row i of the cloud with a normalised rotation (zero quaternion: the identity), turned by `turn`.
SplatRow load_row(const SplatSelection& model, std::int64_t i);

// Morton (Z-order) sorting: chunks of rows get small extents, attribute images smooth gradients.

/// The selection with its rows sorted along a Z-order curve through its bounding box, 2^21 cells per axis. Rows of one
/// cell keep their order.
SplatSelection along_morton_curve(const SplatSelection& model);

// Axis conventions of file formats. Every frame here is that of a PLY with some axes reversed.

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

}  // namespace ngs::io
