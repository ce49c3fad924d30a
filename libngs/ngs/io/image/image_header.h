#pragma once
// Reads the header of a PNG or JPEG without decoding it. Truncated files and absurd sizes are rejected before a decoder
// sees them (decoders print, pad with grey, or allocate what the header declares), and the image size costs little.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

enum class ImageFormat : std::uint8_t { kPng, kJpeg };

struct ImageHeader {
  ImageFormat format = ImageFormat::kPng;
  int width_px = 0, height_px = 0;
  int bits = 8;               // per sample
  bool palette = false;       // PNG colour type 3: samples are indices
  bool begins_black = false;  // the palette's first colour is black
};

/// nullopt: neither PNG nor JPEG. Throws kBadInput if the file is truncated, has no image, or is larger than
/// `kMaxImagePixels`. `object` is the file's name in messages.
std::optional<ImageHeader> parse_image_header(Bytes bytes, const std::string& object);
inline constexpr std::int64_t kMaxImagePixels = std::int64_t(1) << 28;

/// The same bytes without the palette and with the indices declared as grey values, so that any decoder returns the
/// indices (label maps of video trackers are palette PNGs). `bytes` must be a palette PNG.
std::vector<std::uint8_t> palette_png_as_indices(Bytes bytes);

}  // namespace ngs::io
