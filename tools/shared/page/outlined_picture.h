#pragma once
// A picture with the outlines of masks drawn over it: a JPEG as data URI under inline SVG, sharp at any zoom.
#include <string>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/scene/views.h"

namespace ngs::cli {

/// A rectangle of pixels.
struct Window {
  int x = 0, y = 0, width_px = 0, height_px = 0;
};

struct Outline {
  std::string kind;         // class of the lines
  MaskPlane mask;           // without data: not drawn
  std::string colour = {};  // of the lines where the class has none: "#ff6a2b"
};

/// `picture` [H, W, 3] as a data URI.
std::string jpeg_source(const ImageU8& picture, int quality);

/// The unit of the outlines is the pixel of `view_box`, which the picture fills; `alt` is no HTML yet.
std::string outlined_picture(const ImageU8& picture, const std::vector<Outline>& outlines, Window view_box,
                             const std::string& alt);

}  // namespace ngs::cli
