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
/// Colour images that are no masks: those of a mask have a few flat colours. kOnGround: a cut-out on black, or on the
/// colour that most of the border has.
enum class Pictured : std::uint8_t { kMask, kPhoto, kOnGround };
Pictured pictured(const MaskSamples& samples);
/// The channel that decides object or background.
struct DecisiveSamples {
  /// [H·W] alpha of a cut-out, else max(R, G, B), so that an object of any pure colour on black counts; of a picture on
  /// one colour the full value where it has another; of two pure colours, such as red on white, the channel that
  /// differs most.
  std::vector<std::uint16_t> value;
  /// The value that means 1: 255 or 65535. Exceptions: 1 if all values are 0 or 1 (a saved bool array), and 255 if all
  /// values of a 16-bit file are 0 or 255 (a converted 8-bit mask).
  float full_scale = 255;
};
DecisiveSamples decisive_samples(const MaskSamples& samples);
/// [H·W] 1: object, the decisive sample is at least 128/255 of the full scale.
std::vector<std::uint8_t> object_pixels(const MaskSamples& samples);

/// Whether a mask in colours has several besides that of the ground, as a map of objects.
bool has_several_colours(const MaskSamples& samples);

/// Whether a grey picture has many greys, as one of depth.
bool has_many_greys(const MaskSamples& samples);

}  // namespace ngs
