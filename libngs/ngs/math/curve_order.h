#pragma once
// Sorts points along a Z-order (Morton) curve: neighbours in space become neighbours in memory (paper.md §5.1).
//   Morton, "A computer oriented geodetic data base and a new technique in file sequencing", 1966
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace ngs {

/// Spreads the lowest 21 bits of `v`: bit k moves to bit 3 k.
constexpr std::uint64_t spread_by_three(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

inline bool is_finite(const float* point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

/// The bounding box of some points, with 2^21 cells a side.
class MortonGrid {
 public:
  static constexpr std::uint64_t kCells = std::uint64_t(1) << 63;

  /// Extends the box by a point with finite coordinates.
  void include(const float* point) {
    for (std::size_t a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], point[a]);
      high_[a] = std::max(high_[a], point[a]);
    }
  }
  /// Extends the box by all points of another.
  void include(const MortonGrid& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], other.low_[a]);
      high_[a] = std::max(high_[a], other.high_[a]);
    }
  }
  /// The cell of an included point, below kCells; kCells if a coordinate is not finite.
  std::uint64_t cell_of(const float* point) const {
    constexpr double kMaxCell = (1 << 21) - 1;
    if (!is_finite(point)) return kCells;
    std::uint64_t cell = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double span = double(high_[a]) - double(low_[a]);
      const double share = span > 0 ? (double(point[a]) - double(low_[a])) / span : 0;
      cell |= spread_by_three(std::uint64_t(share * kMaxCell)) << a;
    }
    return cell;
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::infinity();
  std::array<float, 3> low_{kFar, kFar, kFar}, high_{-kFar, -kFar, -kFar};
};

struct CurvePoint {
  std::uint64_t cell;
  std::uint32_t row;
};

/// Stable radix sort by cell. Digits that are equal in all cells take no pass. `scratch` has the same size
/// and is overwritten.
inline void sort_by_cell(std::span<CurvePoint> rows, std::span<CurvePoint> scratch) {
  constexpr std::size_t kBits = 8, kDigits = 8, kValues = std::size_t(1) << kBits;
  const auto digit = [](const CurvePoint& r, std::size_t d) { return std::size_t(r.cell >> (kBits * d)) % kValues; };
  std::array<std::array<std::size_t, kValues>, kDigits> count{};
  for (const CurvePoint& r : rows)
    for (std::size_t d = 0; d < kDigits; ++d) ++count[d][digit(r, d)];
  std::span<CurvePoint> from = rows, to = scratch;
  for (std::size_t d = 0; d < kDigits; ++d) {
    if (rows.empty() || count[d][digit(rows.front(), d)] == rows.size()) continue;
    std::size_t at = 0;
    for (std::size_t& next : count[d]) at += std::exchange(next, at);
    for (const CurvePoint& r : from) to[count[d][digit(r, d)]++] = r;
    std::swap(from, to);
  }
  if (from.data() != rows.data()) std::copy(from.begin(), from.end(), rows.begin());
}

/// The indices of the points [N, 3] along a Z-order curve through the bounding box of the finite points, 2^21 cells a
/// side. Points of one cell keep their order; points with a non-finite coordinate come last.
inline std::vector<std::uint32_t> curve_order(std::span<const float> points) {
  MortonGrid grid;
  std::vector<CurvePoint> rows(points.size() / 3), scratch(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (is_finite(&points[3 * i])) grid.include(&points[3 * i]);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = {grid.cell_of(&points[3 * i]), std::uint32_t(i)};
  sort_by_cell(rows, scratch);
  std::vector<std::uint32_t> order(rows.size());
  for (std::size_t place = 0; place < rows.size(); ++place) order[place] = rows[place].row;
  return order;
}

}  // namespace ngs
