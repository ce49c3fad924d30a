#pragma once
// Writes a model without labels. The file name determines the format (output_format()): PLY by write_strict_ply, and
// .compressed.ply, .spz, .sog, .splat, .glb, .usda.
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/formats/splat_format.h"
#include "ngs/io/ply/gaussian_ply.h"

namespace ngs::io {

/// Writes rows with keep[i] != 0, in order; an empty `keep` writes all. Returns warnings for the log, one sentence
/// each: rows left out because the format cannot store them, positions relative to the cloud's origin, and quantisation
/// steps wider than the Gaussians. `comments` and `added` are written to PLY only.
std::vector<std::string> write_splat(const std::string& path, const GaussianCloud& cloud,
                                     const std::vector<std::uint8_t>& keep,
                                     const std::vector<std::string>& comments = {},
                                     const std::optional<AddedColumn>& added = {});
struct PartOfModel {
  const GaussianPly& model;
  const std::vector<std::uint8_t>& keep;  // as above
  const GaussianCloud* edited = nullptr;  // other attributes of the same rows; null: the model's
  // Up in the model, unit length. A PLY keeps the model's axes; other formats are turned until y is up in .glb, .usda
  // and .spz, and -y in the others, as viewers expect it. nullopt: .glb and .usda are turned by vertical_axis.
  std::optional<Vec3<double>> up = {};
  double unit = 1;  // positions and Gaussians are scaled by it, but not in a PLY
};
/// The same with render_comments() and, in a PLY, the further columns of the model; a note names them for other
/// formats.
std::vector<std::string> write_splat(const std::string& path, const PartOfModel& part);

/// The note that `path` lacks the model's further columns; empty: there are none.
std::string note_of_left_columns(const std::string& path, const GaussianPly& model);

Vec3<double> axis_named(std::string_view axis);

}  // namespace ngs::io
