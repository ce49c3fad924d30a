#pragma once
// The object of a run as a page of its own that can be turned: the splat and what draws it in one file, which asks no
// network for anything.
#include <string>

#include "run_folder.h"
#include "viewer_options.h"

namespace ngs::cli {

struct ViewerPage {
  std::string html;
  std::int64_t shown = 0, left_out = 0;  // Gaussians
};

/// Of object.ply in the run's folder, from the view of which the page of the run shows most, else from before the
/// world's z axis. Colours are those of no direction (.splat). kBadInput where there is no object.ply, kNothingFound
/// where it holds nothing.
ViewerPage viewer_page(const RunFolder& run, const ViewerOptions& options);

}  // namespace ngs::cli
