#pragma once
// Writes some rows of a model verbatim: all columns of the input, bytes copied without decoding.
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"

namespace ngs::io {

/// Writes rows with keep[i] != 0, in order, with the input's comments. For compressed.ply, filter_3D and formats other
/// than PLY these are the decoded rows. A column of the input with the name of `added` is replaced.
void write_ply_rows(const std::string& path, const GaussianPly& source, const std::vector<std::uint8_t>& keep,
                    const std::optional<AddedColumn>& added = {});

}  // namespace ngs::io
