#pragma once
// Reads photos and masks, writes PNG and JPEG. In io, only image_resize.cpp and codecs/ use OpenCV. All input is
// untrusted: an unreadable file is kBadInput. EXIF orientation is ignored, as in 3DGS trainers and COLMAP.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/math/vec.h"
#include "ngs/scene/mask_samples.h"
#include "ngs/scene/packed_photo.h"
#include "ngs/scene/views.h"

namespace ngs::io {

/// The samples as stored, 8 or 16 bit; transparent pixels are composited over `behind`, without it alpha is ignored.
PackedPhoto read_photo(const std::string& path, std::optional<Vec3<float>> behind = Vec3<float>{0, 0, 0});

/// The same as [H, W, 3] RGB in [0, 1]: grey is replicated, transparent pixels are composited over `behind`.
ImageF read_image_rgb(const std::string& path, Vec3<float> behind = {0, 0, 0});

bool is_transparent(const std::string& path);

/// How to read the pixels of a palette PNG.
enum class Palette : std::uint8_t {
  kIndices,  // label maps; a JPEG is rejected
  kMask,     // masks: the colours if all are grey (encoders may order them freely) or if the first is not black;
             // else the indices, as trackers write them (0 black, 1 the first object's colour)
  kColours
};

struct RawMask {
  int width_px = 0, height_px = 0, channels = 0;  // 1, 3 (RGB) or 4 (RGBA)
  int bits = 8;                                   // 8 or 16
  bool lossy = false;                             // JPEG: compression has blurred the contours
  std::vector<std::uint16_t> data;                // [H, W, C]
  MaskSamples samples() const { return {width_px, height_px, channels, bits, data}; }
};
RawMask read_mask_raw(const std::string& path, Palette palette);

struct ImageSize {
  int width_px = 0, height_px = 0;
  bool operator==(const ImageSize&) const = default;
};
/// "1024x768"
std::string to_string(ImageSize size);
/// Reads only the header of PNG and JPEG; decodes other formats.
ImageSize read_image_size(const std::string& path);

/// 1, 3 (RGB) or 4 (RGBA) channels. Equal images give equal bytes; writing is atomic.
void write_png(const std::string& path, const ImageU8& image);
void write_png16(const std::string& path, const ImageU16& image);

std::vector<std::uint8_t> encode_png(const ImageU8& image);

/// RGB as JPEG bytes, for HTML pages with embedded images; quality 1..100.
std::vector<std::uint8_t> encode_jpeg(const ImageU8& image, int quality);

/// A picture for a page: a JPEG, or a PNG where there is no encoder for these, in a browser.
struct PagePicture {
  const char* type;  // MIME
  std::vector<std::uint8_t> bytes;
};
PagePicture encode_for_page(const ImageU8& image, int quality);

/// Area average (exact for integer factors); for reductions.
ImageF resize_area(const ImageF& image, int width_px, int height_px);
/// Nearest neighbour: the sample under each target pixel's centre.
ImageF resize_nearest(const ImageF& image, int width_px, int height_px);

// Reads the header of a PNG or JPEG without decoding it. Truncated files and absurd sizes are rejected before a decoder
// sees them (decoders print, pad with grey, or allocate what the header declares), and the image size costs little.

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
