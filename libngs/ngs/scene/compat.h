#pragma once
// Whose constants a renderer follows where the two families differ.                                PAPER.md §5.1
#include <cstdint>

namespace ngs {

enum class Compat : std::uint8_t { kInria, kGsplat };

}  // namespace ngs
