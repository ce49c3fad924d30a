#pragma once
// A page that shows the object of a run in 3D: splat and WebGL renderer in one file, without network access.
#include <string>

#include "run_folder.h"
#include "viewer_options.h"

namespace ngs::cli {

struct ViewerPage {
  std::string html;
  std::int64_t shown = 0, left_out = 0;  // Gaussians
};

/// Page for object.ply of the run's folder. First camera: that of median_view(), otherwise the first view of the scene,
/// otherwise one on the negative z axis. Colours have no view dependence, as in .splat. kBadInput without object.ply,
/// kNothingFound if it contains no Gaussian to draw.
ViewerPage viewer_page(const RunFolder& run, const ViewerOptions& options);

}  // namespace ngs::cli
