#pragma once
// Photos and masks in, PNG out. With codecs/ the only user of OpenCV in io. All files are hostile: an unreadable
// one is kBadInput. EXIF orientation is ignored, as the trainers and COLMAP do.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/math/vec.h"
#include "ngs/scene/packed_photo.h"
#include "ngs/scene/mask_samples.h"
#include "ngs/scene/views.h"

namespace ngs::io {

/// The samples as they are in the file, 8 or 16 bit; where pixels are transparent, `behind` shows through.
PackedPhoto read_photo(const std::string& path, Vec3<float> behind = {0, 0, 0});

/// The same as [H, W, 3] RGB in [0, 1]: grey is replicated; where pixels are transparent, `behind` shows through.
ImageF read_image_rgb(const std::string& path, Vec3<float> behind = {0, 0, 0});

/// Whether any pixel is transparent.
bool is_transparent(const std::string& path);

/// What the pixels of a palette PNG are.
enum class Palette : std::uint8_t {
  kIndices,  // label maps; a JPEG is no label map
  kMask,     // a mask: the colours where they are all grey, whatever the order in which an encoder put them, or where
             // the first is not black; else the indices, as trackers write them (0 black, 1 the first object's colour)
  kColours
};

/// Samples as they are in the file.
struct RawMask {
  int width_px = 0, height_px = 0, channels = 0;  // 1, 3 (RGB) or 4 (RGBA)
  int bits = 8;                                   // 8 or 16
  bool lossy = false;                             // JPEG: contours are blurred by compression
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
/// Reads no more than the header of PNG and JPEG; decodes anything else.
ImageSize read_image_size(const std::string& path);

/// 1, 3 (RGB) or 4 (RGBA) channels. The same image gives the same bytes; appears by rename.
void write_png(const std::string& path, const ImageU8& image);
void write_png16(const std::string& path, const ImageU16& image);

/// The bytes that write_png() writes.
std::vector<std::uint8_t> encode_png(const ImageU8& image);

/// RGB as JPEG bytes, for pages that hold their pictures; quality 1..100.
std::vector<std::uint8_t> encode_jpeg(const ImageU8& image, int quality);

/// Mean over the covered area (exact for integer factors); for reductions.
ImageF resize_area(const ImageF& image, int width_px, int height_px);
/// The sample under each target pixel's centre.
ImageF resize_nearest(const ImageF& image, int width_px, int height_px);

}  // namespace ngs::io
