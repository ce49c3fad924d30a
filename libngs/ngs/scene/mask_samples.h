#pragma once
// Object pixels of a mask file, the same for all tools.
#include <cstdint>
#include <span>
#include <vector>

namespace ngs {

/// Unconverted samples of a file, [H, W, C]: grey, RGB or RGBA.
struct MaskSamples {
  int width_px = 0, height_px = 0, channels = 1, bits = 8;
  std::span<const std::uint16_t> data;
};

/// Whether alpha is not constant: then alpha is the mask.
bool is_cut_out(const MaskSamples& samples);
/// Whether R = G = B everywhere.
bool is_grey(const MaskSamples& samples);
/// Classifies a colour image: a mask has few flat colours, a photo has many. kPhotoOnOneColour: a cut-out photo on
/// black, or on the colour of most of the border.
enum class ImageKind : std::uint8_t { kMask, kPhoto, kPhotoOnOneColour };
ImageKind image_kind(const MaskSamples& samples);
/// The channel that decides object or background.
struct DecisiveSamples {
  /// [H·W] by kind of image. Varying alpha: alpha. kPhotoOnOneColour: full scale where the colour differs from the
  /// background. Two pure colours, such as red on white: the channel that differs most. Others: max(R, G, B), so that
  /// an object of any pure colour on black is found.
  std::vector<std::uint16_t> value;
  /// The value that means 1: 255 or 65535. Exceptions: 1 if all values are 0 or 1 (a saved bool array), and 255 if all
  /// values of a 16-bit file are 0 or 255 (a converted 8-bit mask).
  float full_scale = 255;
};
DecisiveSamples decisive_samples(const MaskSamples& samples);
/// [H·W] 1: object, the decisive sample is at least 128/255 of the full scale.
std::vector<std::uint8_t> object_pixels(const MaskSamples& samples);

/// Whether a colour mask has several colours besides the background's, as a label map has.
bool has_several_colours(const MaskSamples& samples);

/// Whether a grey image has many grey levels, as a depth map has.
bool has_many_greys(const MaskSamples& samples);

}  // namespace ngs
