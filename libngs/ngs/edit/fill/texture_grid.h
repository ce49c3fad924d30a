#pragma once
// A texture with a hole.
#include <cstdint>
#include <vector>

namespace ngs {

enum class Texel : std::uint8_t { kNone, kKnown, kUnknown };  // kNone: no part of the texture, never read

struct TextureGrid {
  std::int64_t columns = 0, rows = 0;
  std::vector<Texel> state;   // [rows · columns]
  std::vector<float> colour;  // [rows · columns, 3] any finite values where known
};

}  // namespace ngs
