#pragma once
// What a PNG or JPEG says about itself, found without decoding it. Used to refuse truncated and absurd files
// before a decoder sees them (decoders print, pad with grey, or allocate what a header claims), and to learn
// an image's size cheaply.
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

/// Empty: neither PNG nor JPEG. Throws kBadInput where the file is one of them but truncated, without an
/// image, or larger than `kMaxImagePixels`. `object` names the file in messages.
std::optional<ImageHeader> parse_image_header(Bytes bytes, const std::string& object);
inline constexpr std::int64_t kMaxImagePixels = std::int64_t(1) << 28;

/// The same bytes with the palette taken out and the indices declared grey values, so that any decoder
/// returns the indices (label maps from video trackers are palette PNGs). `bytes` must be a palette PNG.
std::vector<std::uint8_t> palette_png_as_indices(Bytes bytes);

}  // namespace ngs::io
