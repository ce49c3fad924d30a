#pragma once
// Image decoding and encoding with OpenCV. OpenCV loads 130 other libraries (maps, databases, medical images), which
// takes longer than the work of a small tool. It is therefore in a plug-in, libngs_codecs.so next to the executables,
// which is loaded with the first image. The OpenCV of NGS_ONE_PROGRAM has no such libraries and is linked.
#include <cstdint>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct PictureView {
  int width_px = 0, height_px = 0;
  int channels = 0;               // 1, 3 (RGB) or 4 (RGBA)
  int bits = 0;                   // 8 or 16, native byte order; 0: an unsupported sample type
  const void* samples = nullptr;  // [H, W, C] without padding
};

/// Owns the data of a PictureView. width_px is 0 if the bytes are not an image; samples is empty if bits is 0.
struct Picture {
  int width_px = 0, height_px = 0, channels = 0, bits = 0;
  std::vector<std::uint8_t> samples;
};

struct ImageCodecs {
  Picture (*decode)(Bytes bytes);  // throws std::bad_alloc only
  /// Empty if the encoder failed. Equal pictures give equal bytes.
  std::vector<std::uint8_t> (*encode_png)(const PictureView& picture);
  std::vector<std::uint8_t> (*encode_jpeg)(const PictureView& picture, int quality);  // null: there is no encoder
};

/// Loads the plug-in on the first call, from any thread; kEnvironment if it is missing.
const ImageCodecs& image_codecs();

}  // namespace ngs::io
