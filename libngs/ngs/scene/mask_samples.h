#pragma once
// What a mask file says of its pixels, whichever tool reads it.
#include <cstdint>
#include <span>
#include <vector>

namespace ngs {

/// Samples as they are in a file, [H, W, C]: grey, RGB or RGBA.
struct MaskSamples {
  int width_px = 0, height_px = 0, channels = 1, bits = 8;
  std::span<const std::uint16_t> data;
};

/// Alpha is not constant: what is cut out by it is the object.
bool is_cut_out(const MaskSamples& samples);
/// R = G = B everywhere.
bool is_grey(const MaskSamples& samples);
/// [H·W] the samples that decide whether a pixel is object: alpha of a cut-out, else the largest of R, G, B, so that
/// an object of any pure colour on black is one.
std::vector<std::uint16_t> decisive_channel(const MaskSamples& samples);
/// The value that stands for 1: 255 or 65535, except where the decisive samples are zeros and ones (a bool array that
/// was saved as an image) or, in 16 bit, 0 and 255 (a mask of 8 bit that was).
float full_scale(const MaskSamples& samples);
/// The decisive samples are zeros and ones, 1 is the object.
bool is_zero_one(const MaskSamples& samples);
/// [H·W] 1: the decisive sample is at least 128/255 of the full scale.
std::vector<std::uint8_t> object_pixels(const MaskSamples& samples);

}  // namespace ngs
