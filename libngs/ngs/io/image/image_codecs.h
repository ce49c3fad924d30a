#pragma once
// Pictures as files hold them, decoded and encoded by OpenCV. That library brings 130 others along (maps, databases,
// medical images), and loading them takes longer than the work of a small tool; so it stands behind a plug-in,
// libngs_codecs.so beside the executables, which is loaded with the first picture.
#include <cstdint>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct PictureView {
  int width_px = 0, height_px = 0;
  int channels = 0;               // 1, 3 (RGB) or 4 (RGBA)
  int bits = 0;                   // 8 or 16, native byte order; 0: a type of sample that ngs does not read
  const void* samples = nullptr;  // [H, W, C] without padding
};

/// Owns what PictureView shows; width_px is 0 where the bytes are no picture, samples is empty where bits is 0.
struct Picture {
  int width_px = 0, height_px = 0, channels = 0, bits = 0;
  std::vector<std::uint8_t> samples;
};

struct ImageCodecs {
  Picture (*decode)(Bytes bytes);  // never throws but for lack of memory
  /// Empty where the encoder failed. The same picture gives the same bytes.
  std::vector<std::uint8_t> (*encode_png)(const PictureView& picture);
  std::vector<std::uint8_t> (*encode_jpeg)(const PictureView& picture, int quality);
};

/// Loads the plug-in at the first call, from any thread; kEnvironment where it is missing.
const ImageCodecs& image_codecs();

}  // namespace ngs::io
