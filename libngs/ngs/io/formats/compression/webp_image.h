#pragma once
// WebP pictures as tables of bytes.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

inline constexpr int kMostWebpPx = 16383;  // a side

struct RgbaTable {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  // [height, width, 4]

  std::size_t texels() const { return std::size_t(width) * std::size_t(height); }
  const std::uint8_t* texel(std::size_t i) const { return bytes.data() + i * 4; }
  std::uint8_t* texel(std::size_t i) { return bytes.data() + i * 4; }
};

/// kBadInput, in the name of `object`, for anything but a whole picture, and before memory is taken for one of more
/// than `most_texels`.
RgbaTable decode_webp(const std::string& object, Bytes bytes, std::size_t most_texels);

/// Lossless, also where alpha is 0; the same table gives the same bytes.
std::vector<std::uint8_t> encode_webp(const RgbaTable& table);

}  // namespace ngs::io
