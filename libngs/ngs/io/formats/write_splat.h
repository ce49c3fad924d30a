#pragma once
// Writes a model without labels in the format that the name of the file asks for (output_format()): PLY by
// write_strict_ply, and .compressed.ply, .spz, .sog, .splat, .glb.
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"

namespace ngs::io {

/// Rows with keep[i] != 0, in order; an empty `keep` means all. Returns what the reader of a log should know, one
/// sentence each: how many rows were left out because the format cannot hold them, positions that are relative to the
/// cloud's origin, and steps that are wider than the Gaussians. `comments` go into PLY only.
std::vector<std::string> write_splat(const std::string& path, const GaussianCloud& cloud,
                                     const std::vector<std::uint8_t>& keep,
                                     const std::vector<std::string>& comments = {});
/// The same with the comments of the input that say how to render it.
std::vector<std::string> write_splat(const std::string& path, const GaussianPly& model,
                                     const std::vector<std::uint8_t>& keep);

}  // namespace ngs::io
