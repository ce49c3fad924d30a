#pragma once
// Cells of a regular grid around a centre, as keys of 21 bits per axis. Positions beyond the grid are in
// its outermost cells.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "ngs/math/vec.h"

namespace ngs {

class CellGrid {
 public:
  /// `side` > 0, world.
  CellGrid(Vec3<double> centre, double side) : centre_(centre), side_(side) {}

  /// The cell of a finite position, world.
  std::uint64_t of(const float* position) const {
    return key(along(double(position[0]) - centre_.x), along(double(position[1]) - centre_.y),
               along(double(position[2]) - centre_.z));
  }
  /// Calls visit(cell) for the cell and its 26 neighbours.
  template <class Visit>
  static void for_neighbours(std::uint64_t cell, const Visit& visit) {
    const auto axis = [cell](int a) { return std::int64_t(cell >> (21 * a) & (2 * kMiddle - 1)); };
    for (std::int64_t z = axis(2) - 1; z <= axis(2) + 1; ++z)
      for (std::int64_t y = axis(1) - 1; y <= axis(1) + 1; ++y)
        for (std::int64_t x = axis(0) - 1; x <= axis(0) + 1; ++x) visit(key(x, y, z));
  }

 private:
  static constexpr std::int64_t kMiddle = std::int64_t(1) << 20;
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return std::uint64_t(x) | std::uint64_t(y) << 21 | std::uint64_t(z) << 42;
  }
  std::int64_t along(double offset) const {
    return kMiddle + std::int64_t(std::clamp(std::floor(offset / side_), 1 - double(kMiddle), double(kMiddle) - 1));
  }

  Vec3<double> centre_;
  double side_;
};

}  // namespace ngs
