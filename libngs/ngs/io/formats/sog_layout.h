#pragma once
// Definitions shared by the reader and the writer of .sog.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ngs/math/stable.h"

namespace ngs::io::sog {

inline constexpr std::size_t kPaletteColumns = 64, kMaxPalette = 65536;
inline constexpr double kMaxWord = 65535, kMaxByte = 255;
inline constexpr int kFirstMode = 252;  // of quaternions

/// Components of (w, x, y, z) other than the largest, in file order.
inline constexpr std::array<std::array<std::size_t, 3>, 4> kOthers = {{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// Positions are stored as sign(p) ln(1 + |p|): the step grows with |p|.
inline double compressed(double p) {
  // ln(1 + x) by Kahan's correction of the logarithm: unlike log1p of a double it hardly differs between C libraries.
  const double x = std::abs(p), sum = 1 + x;
  return std::copysign(sum > 1 ? std::log(sum) * (x / (sum - 1)) : x, p);
}
inline double expanded(double c) { return std::copysign(std::expm1(std::abs(c)), c); }

/// Decodes a stored number `v` in 0..`most` to the range `low`..`high`.
inline double between(double low, double high, double v, double most) { return low + (high - low) * (v / most); }

}  // namespace ngs::io::sog
