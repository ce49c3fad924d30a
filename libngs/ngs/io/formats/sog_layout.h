#pragma once
// What readers and writers of .sog share.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ngs/math/stable.h"

namespace ngs::io::sog {

inline constexpr std::size_t kPaletteColumns = 64, kMostPalette = 65536;
inline constexpr double kMostWord = 65535, kMostByte = 255;
inline constexpr int kFirstMode = 252;  // of quaternions

/// Components of (w, x, y, z) beside the largest, in the order of the file.
inline constexpr std::array<std::array<std::size_t, 3>, 4> kOthers = {{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// Positions are stored by the sign and the logarithm of 1 + |p|: far ones more coarsely.
inline double compressed(double p) { return std::copysign(std::log1p(std::abs(p)), p); }
inline double expanded(double c) { return std::copysign(std::expm1(std::abs(c)), c); }

/// A stored number `v` of 0 to `most`, between `low` and `high`.
inline double between(double low, double high, double v, double most) { return low + (high - low) * (v / most); }

}  // namespace ngs::io::sog
