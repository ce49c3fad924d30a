#pragma once
// Some rows of a model as they came: every column of the input, its bytes copied, nothing decoded and encoded again.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"

namespace ngs::io {

struct AddedColumn {
  std::string name;
  std::span<const float> values;  // [N] of the input's rows
};

/// Rows with keep[i] != 0, in order, with the input's comments. Of a compressed.ply, a filter_3D column and the formats
/// that are no PLY the rows are the decoded ones. A column of the input that has the name of `added` is replaced.
void write_ply_rows(const std::string& path, const GaussianPly& source, const std::vector<std::uint8_t>& keep,
                    const std::optional<AddedColumn>& added = {});

}  // namespace ngs::io
