#pragma once
// Lossless WebP images, used as tables of bytes.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

inline constexpr int kMaxWebpSide_px = 16383;

struct RgbaImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;  // [height, width, 4]

  std::size_t texels() const { return std::size_t(width) * std::size_t(height); }
  const std::uint8_t* texel(std::size_t i) const { return bytes.data() + i * 4; }
  std::uint8_t* texel(std::size_t i) { return bytes.data() + i * 4; }
};

/// kBadInput, with `object` in the message, unless the image is complete and has at most `max_texels`; the size is
/// checked before memory is allocated.
RgbaImage decode_webp(const std::string& object, Bytes bytes, std::size_t max_texels);

/// Lossless, also where alpha is 0; equal images give equal bytes.
std::vector<std::uint8_t> encode_webp(const RgbaImage& table);

}  // namespace ngs::io
