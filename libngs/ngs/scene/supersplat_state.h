#pragma once
// Bits of SuperSplat's column `state`.
#include <cstdint>

namespace ngs {

inline constexpr std::uint8_t kSelectedState = 1, kDeletedState = 4;

}  // namespace ngs
