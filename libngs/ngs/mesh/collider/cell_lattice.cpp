#include <algorithm>
#include <cmath>

#include "ngs/mesh/collider/piece.h"

namespace ngs::mesh {
namespace {

std::uint64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  return std::uint64_t(x) << 42 | std::uint64_t(y) << 21 | std::uint64_t(z);
}

}  // namespace

CellLattice::CellLattice(const GridMesh& solid, std::int64_t pitch) : pitch_(pitch) {
  constexpr std::int64_t kSide = kRaysPerSide;
  for (const RaySpan& span : spans_inside(solid, pitch / kSide)) {
    const auto last = std::int64_t(std::floor(span.high / double(pitch)));
    for (auto z = std::int64_t(std::floor(span.low / double(pitch))); z <= last; ++z) {
      const double low = std::max(span.low, double(z * pitch));
      const double high = std::min(span.high, double((z + 1) * pitch));
      if (!(high > low)) continue;
      const std::int64_t x = span.i / kSide;
      const std::int64_t y = span.j / kSide;
      const auto [row, is_new] = rows_.emplace(key_of(x, y, z), std::uint32_t(cells_.size()));
      if (is_new) cells_.push_back({{std::int32_t(x), std::int32_t(y), std::int32_t(z)}, 0, {}});
      cells_[row->second].share += (high - low) / double(pitch * kSide * kSide);
    }
  }
  for (Cell& cell : cells_) {
    const auto [x, y, z] = cell.place;
    cell.next = {row_at(x + 1, y, z), row_at(x, y + 1, z), row_at(x, y, z + 1)};
  }
}

std::uint32_t CellLattice::row_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
  if (x < 0 || y < 0 || z < 0) return kNoRow;
  const auto found = rows_.find(key_of(x, y, z));
  return found == rows_.end() ? kNoRow : found->second;
}

GridPoint CellLattice::middle(std::uint32_t row) const {
  const auto [x, y, z] = cells_[row].place;
  return {x * pitch_ + pitch_ / 2, y * pitch_ + pitch_ / 2, z * pitch_ + pitch_ / 2};
}

std::uint32_t CellLattice::near(GridPoint p) const {
  const std::int64_t x = p.x / pitch_;
  const std::int64_t y = p.y / pitch_;
  const std::int64_t z = p.z / pitch_;
  std::uint32_t best = row_at(x, y, z);
  if (best != kNoRow) return best;
  for (std::int64_t k = 0; k < 27; ++k) {
    const std::uint32_t row = row_at(x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1);
    if (row != kNoRow && (best == kNoRow || cells_[row].share > cells_[best].share)) best = row;
  }
  return best;
}

}  // namespace ngs::mesh
