#pragma once
// Pixels of user-made pictures as 8-bit colours.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <unordered_map>

#include "ngs/io/image/image_file.h"

namespace ngs::io {

using Colour8 = std::array<int, 3>;  // R, G, B in 0..255

/// For pictures with 1, 3 or 4 channels of 8 or 16 bits; grey is replicated.
inline Colour8 colour_of(const RawMask& picture, std::size_t pixel) {
  const auto channels = std::size_t(picture.channels);
  Colour8 colour;
  for (std::size_t c = 0; c < 3; ++c) {
    const int value = picture.data[pixel * channels + std::min(c, channels - 1)];
    colour[c] = picture.bits == 16 ? value / 257 : value;
  }
  return colour;
}

/// Whether a pixel is transparent: it is not painted, whatever colour the file stores for it.
inline bool is_see_through(const RawMask& picture, std::size_t pixel) {
  if (picture.channels != 4) return false;
  const int alpha = picture.data[4 * pixel + 3];
  return (picture.bits == 16 ? alpha / 257 : alpha) < 128;
}

/// The largest difference over the channels.
inline int distance_of(const Colour8& a, const Colour8& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// A colour histogram with cells of 8 levels per channel.
class ColourCounts {
 public:
  void add(const Colour8& colour) { ++count_[cell_of(colour)]; }
  bool empty() const { return count_.empty(); }
  /// The centre of the fullest cell; of ties the darkest. Black if there is none.
  Colour8 most_frequent() const {
    int cell = 0;
    std::int64_t most = 0;
    for (const auto& [key, count] : count_)
      if (count > most || (count == most && key < cell)) {
        cell = key;
        most = count;
      }
    return {8 * (cell >> 10) + 4, 8 * (cell >> 5 & 31) + 4, 8 * (cell & 31) + 4};
  }

 private:
  static int cell_of(const Colour8& c) { return (c[0] / 8) << 10 | (c[1] / 8) << 5 | c[2] / 8; }
  std::unordered_map<int, std::int64_t> count_;
};

}  // namespace ngs::io
