#pragma once
// Which sizes of a file are "the same picture" as a camera's image.
#include "ngs/io/image/image_file.h"

namespace ngs::io {

/// How far a file's size is from the camera's. `allowed`: both sides differ by the same integer factor k
/// (1..16, either way), with or without the scene's image_scale, each side within 1 px of rounding; or by any factor of
/// up to 16, each side of 32 px at least, where a side that fits leaves the other less than 1 px off.
struct SizeRelation {
  bool allowed = false;
  bool same = false;
  bool larger = false;  // the file has more pixels
};

SizeRelation relate_sizes(ImageSize file, ImageSize camera, double image_scale);
/// The same for masks, which may also be 1 px wider, narrower, higher or lower than the photo or the camera's image:
/// tools that scale photos round either way (sides of 100 px and more, where that is 1 % at most). A photo may not,
/// its pixels lie where the camera says.
SizeRelation relate_mask_size(ImageSize file, ImageSize camera, double image_scale);

/// The file would suit the camera if it were turned by 90 degrees.
bool is_turned(ImageSize file, ImageSize camera, double image_scale);

}  // namespace ngs::io
