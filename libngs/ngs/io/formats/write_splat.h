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
/// The same with those comments of the input that affect rendering.
std::vector<std::string> write_splat(const std::string& path, const GaussianPly& model,
                                     const std::vector<std::uint8_t>& keep);

}  // namespace ngs::io
