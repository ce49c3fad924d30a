#pragma once
// First section of the page: pictures of the cut object that flip on a click (CSS only), and the boundary set from
// three sides.
#include <string>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

/// The view with the median score among those with photo and predicted mask; null if there is none.
const ShownView* median_view(const RunFolder& run);

/// Pairs of pictures of median_view(): photo and object, photo and background, input mask and result, each if its files
/// exist. All open on the result. `viewer`: URL of the 3D page, which is linked first, or empty. Only this link without
/// photo and mask.
std::string overview_section(const Exec& exec, RunFolder& run, Pictures& pictures, const std::string& viewer);

/// The marked views with their strokes, marked/NAME.png of ngs cut. Empty without them.
std::string marked_section(RunFolder& run, Pictures& pictures);

/// Pictures of labelled.ply along the world's axes. Empty without labelled.ply or boundary set.
std::string boundary_section(RunFolder& run, Pictures& pictures);

/// The command line of every tool, from reports/TOOL.sh.
std::string repeat_section(const RunFolder& run);

}  // namespace ngs::cli
