#pragma once
// What the readers of all formats but PLY make, and what their writers start from: Gaussians in the encoding and the
// frame of a PLY (x right, y down, z forward).
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/ply_types.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::io {

struct SplatRow {
  std::array<float, 3> position{};  // world
  std::array<float, 3> sh_dc{};     // rgb = 0.5 + 0.28209479 · sh_dc
  std::array<float, 45> sh_rest{};  // [coefficient · 3 + channel]; 3 · sh_rest_count(degree) of them are used
  float logit_opacity = 0;
  std::array<float, 3> log_scale{};
  std::array<float, 4> rotation{};  // w x y z
};

/// A model as decoded from a file.
struct DecodedSplat {
  PlyTable rows;                   // x y z f_dc_* f_rest_* opacity scale_* rot_*, all float, packed
  bool antialiased = false;        // the file says that it was trained with Mip-Splatting's opacity compensation
  std::vector<std::string> notes;  // what a reader of the file should know, one sentence each
};

/// Takes the memory for `count` Gaussians: callers have checked that the file can hold as many.
PlyTable splat_table(std::int64_t count, int sh_degree);

/// Fills row i of such a table.
void store_row(PlyTable& table, std::int64_t i, const SplatRow& row);

/// The part of a model that goes into a file. Formats with quantised values cannot hold what is not finite: such rows
/// (GaussianCloud::usable) are left out.
struct SplatSelection {
  const GaussianCloud& cloud;
  std::vector<std::int64_t> rows;
  std::int64_t left_out = 0;
  std::array<double, 3> shift{};  // what is added to positions: the cloud's origin, but where needs_local_origin()
};

/// Positions that a format rounds by more than the usual size of a Gaussian (usual_size()).
struct Rounding {
  std::int64_t rows = 0;      // so many
  double step = 0;            // the widest step, world
  std::int64_t farthest = 0;  // the row of the cloud that forces it, by
  double coordinate = 0;      // its farthest coordinate
};

/// Rows with keep[i] != 0; an empty `keep` means all.
SplatSelection select_rows(const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep);

/// Row i of the cloud with its rotation of unit length (a zero quaternion: the identity).
SplatRow load_row(const SplatSelection& model, std::int64_t i);

}  // namespace ngs::io
