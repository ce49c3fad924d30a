#pragma once
// Matrix views (non-owning, trivially copyable, passed to kernels by value) and owned images.
#include <cstdint>
#include <vector>

#include "ngs/core/hd.h"
#include "ngs/math/vec.h"

namespace ngs {

/// Row-major [N, C], C known at compile time.
template <class T, int C>
struct Rows {
  T* data = nullptr;
  std::int64_t n = 0;
  NGS_HD T* row(std::int64_t i) const { return data + i * C; }
};

/// Row-major [N, C], C known at run time.
template <class T>
struct Matrix {
  T* data = nullptr;
  std::int64_t n = 0;
  int c = 0;
  NGS_HD T* row(std::int64_t i) const { return data + i * c; }
};

/// An owned image: interleaved channels, row-major, top-left first. The centre of pixel (x, y) is at (x + 0.5, y +
/// 0.5).
template <class T>
struct Image {
  int width_px = 0, height_px = 0, channels = 0;
  std::vector<T> data;  // [H, W, C]

  Image() = default;
  Image(int width, int height, int channel_count, T fill = T(0))
      : width_px(width),
        height_px(height),
        channels(channel_count),
        data(std::size_t(width) * std::size_t(height) * std::size_t(channel_count), fill) {}
  bool empty() const { return data.empty(); }
  std::int64_t pixels() const { return std::int64_t(width_px) * height_px; }
  std::size_t index(int x, int y, int c = 0) const {
    return (std::size_t(y) * std::size_t(width_px) + std::size_t(x)) * std::size_t(channels) + std::size_t(c);
  }
  T& at(int x, int y, int c = 0) { return data[index(x, y, c)]; }
  const T& at(int x, int y, int c = 0) const { return data[index(x, y, c)]; }
};
using ImageF = Image<float>;
using ImageU8 = Image<std::uint8_t>;
using ImageU16 = Image<std::uint16_t>;

}  // namespace ngs
