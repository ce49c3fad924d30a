#pragma once
// Vector quantisation for .sog: replaces many values, or rows, by few representatives.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ngs::io {

inline constexpr std::size_t kCodebookSize = 256;
using Codebook = std::array<float, kCodebookSize>;  // ascending

/// The 256 values with the least sum of squared distances to `values`, optimal over 4096 bins between the smallest and
/// the largest value. Up to 256 distinct values are kept exactly; no values give zeros.
Codebook fit_codebook(std::span<const float> values);

/// The index of the nearest value; the smaller value of two equally near ones.
std::uint8_t nearest_in(const Codebook& codebook, float value);

struct RowPalette {
  std::vector<float> rows;           // [size, columns]
  std::vector<std::uint32_t> label;  // [n] index of the row that represents row i
};

/// At most `size` rows: cluster means. Starting from one cluster, the cluster with the largest sum of squares about
/// its mean is split repeatedly, at the mean of its column of largest variance. Up to `size` distinct rows are kept
/// exactly. Equal tables give equal palettes.
RowPalette fit_palette(std::span<const float> table, std::size_t columns, std::size_t size);

}  // namespace ngs::io
