#pragma once
// K nearest neighbours of Q queries among B points, as a table and as its transpose.
#include <cstdint>
#include <vector>

#include "ngs/scene/views.h"

namespace ngs {

inline constexpr int kMaxNeighbours = 32;

struct KnnGraph {
  int neighbours = 0;                // K; fewer than requested if there are fewer points
  std::int64_t points = 0;           // B
  std::vector<std::uint32_t> index;  // [Q, K] into the points; each row ordered by (dist2, index)
  std::vector<float> dist2;          // [Q, K] squared distance, world²

  // The transpose: the (query, slot) pairs that refer to point j. A backward pass gathers with it.
  std::vector<std::int64_t> row_begin;  // [B + 1]
  std::vector<std::int64_t> edge;       // [Q·K] flat indices query·K + slot, ascending within a row

  std::int64_t queries() const { return neighbours == 0 ? 0 : std::int64_t(index.size()) / neighbours; }
  Matrix<const std::uint32_t> indices() const { return {index.data(), queries(), neighbours}; }
};

}  // namespace ngs
