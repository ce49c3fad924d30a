#pragma once
// Decides which file sizes show "the same picture" as a camera's image.
#include "ngs/io/image/image_file.h"

namespace ngs::io {

/// Relation of a file's size to the camera's. `allowed`: both sides differ by the same integer factor k (1..16, either
/// direction), with or without the scene's image_scale, each side within 1 px of rounding; or by any factor up to 16,
/// if each side has at least 32 px and matching one side leaves the other less than 1 px off.
struct SizeRelation {
  bool allowed = false;
  bool same = false;
  bool larger = false;  // the file has more pixels
};

SizeRelation relate_sizes(ImageSize file, ImageSize camera, double image_scale);
/// The same for masks, which may also be 1 px wider, narrower, higher or lower than the photo or the camera's image,
/// because tools that scale photos round differently (sides of 100 px and more, where that is at most 1 %). Photos may
/// not: their pixels must match the camera's exactly.
SizeRelation relate_mask_size(ImageSize file, ImageSize camera, double image_scale);

/// Whether the file would fit the camera after a rotation by 90 degrees.
bool is_turned(ImageSize file, ImageSize camera, double image_scale);

}  // namespace ngs::io
