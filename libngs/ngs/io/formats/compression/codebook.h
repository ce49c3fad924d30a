#pragma once
// Vector quantisation for .sog: a few values, or rows, that stand for many.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ngs::io {

inline constexpr std::size_t kCodebookSize = 256;
using Codebook = std::array<float, kCodebookSize>;  // ascending

/// The 256 values with the least sum of squared distances to `values`: exact over 4096 bins between the smallest and
/// the largest. Up to 256 different values are kept as they are; none give zeros.
Codebook fit_codebook(std::span<const float> values);

/// The index of the nearest value; of two equally near the smaller.
std::uint8_t nearest_in(const Codebook& codebook, float value);

/// Rows that stand for the rows of a table.
struct Palette {
  std::vector<float> rows;           // [size, columns]
  std::vector<std::uint32_t> label;  // [n] which stands for a row
};

/// At most `size` rows: the means of groups, made by splitting again and again the group with the largest sum of
/// squares about its mean, at the mean of the column that varies most in it. Up to `size` different rows are kept as
/// they are. The same table gives the same palette.
Palette fit_palette(std::span<const float> table, std::size_t columns, std::size_t size);

}  // namespace ngs::io
