#pragma once
// A picture with mask outlines drawn over it: a JPEG data URI under inline SVG, sharp at any zoom.
#include <string>
#include <vector>

#include "ngs/ops/image/pixel_window.h"
#include "ngs/scene/views.h"

namespace ngs::cli {

struct Outline {
  std::string kind;         // CSS class of the lines
  MaskPlane mask;           // without data: not drawn
  std::string colour = {};  // colour of the lines if the class has none: "#ff6a2b"
};

/// `picture` [H, W, 3] as a JPEG data URI.
std::string jpeg_source(const ImageU8& picture, int quality);

/// Outlines are in pixels of `view_box`, which the picture fills; `alt` is plain text.
std::string outlined_picture(const ImageU8& picture, const std::vector<Outline>& outlines, const PixelWindow& view_box,
                             const std::string& alt);

}  // namespace ngs::cli
