#pragma once
// The input masks, each over its photo, to be checked before anything is run.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/ops/image/pixel_window.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/views.h"

namespace ngs::cli {

struct MaskSheetOptions {
  int width_px = 240;       // per picture
  double budget_mib = 8.0;  // for all pictures together
};

struct MaskSheet {
  std::string html;                      // figures and legend; empty: no view has a mask
  std::vector<std::string> problems;     // masks and photos that could not be read
  std::int64_t shown = 0, left_out = 0;  // views with a mask; left_out: over the budget
  std::vector<std::string> without;      // views without a mask
};

/// One picture per view with a mask, in the scene's order. Background is darkened, unknown pixels are hatched in grey,
/// and each object has an outline.
MaskSheet mask_sheet(const Scene& scene, const MaskSheetOptions& options);

std::string mask_sheet_page(const Scene& scene, const MaskSheet& sheet);

/// A title for the scene: the folder name of its capture, empty if that is generic. Plain text.
std::string scene_title(const Scene& scene);

// A picture with mask outlines drawn over it: a JPEG data URI under inline SVG, sharp at any zoom.
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
