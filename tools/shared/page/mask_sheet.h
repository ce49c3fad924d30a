#pragma once
// The masks that were given, each over its photo: what people look at before they run anything.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::cli {

struct MaskSheetOptions {
  int width_px = 240;       // of a picture
  double budget_mib = 8.0;  // all pictures together
};

struct MaskSheet {
  std::string html;                      // figures, with their legend; empty: no view has a mask
  std::vector<std::string> problems;     // masks and photos that could not be read
  std::int64_t shown = 0, left_out = 0;  // views with a mask; left out: beyond the budget
  std::vector<std::string> without;      // views that have none
};

/// Of every view with a mask, in the scene's order. What no mask says to be an object's is darkened, what is unknown is
/// hatched out in grey; each object has its outline.
MaskSheet mask_sheet(const Scene& scene, const MaskSheetOptions& options);

/// The sheet as a page of its own.
std::string mask_sheet_page(const Scene& scene, const MaskSheet& sheet);

/// What people call the scene: the folder of its capture; empty where that says nothing. No HTML yet.
std::string scene_title(const Scene& scene);

}  // namespace ngs::cli
