#pragma once
// The sections of one run. A section without content is empty.
#include <string>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

std::string tiles(const RunFolder& run);
std::string warnings_section(const RunFolder& run);
std::string accuracy_section(const RunFolder& run);
std::string views_section(RunFolder& run, Pictures& pictures);
std::string view_scores(const RunFolder& run);
std::string objects_section(const RunFolder& run);
std::string decisions_section(const RunFolder& run);
std::string times_section(const RunFolder& run);
std::string trace_section(const RunFolder& run);
/// Contact sheet of the input masks over their photos. Empty if no view has a mask.
std::string given_section(RunFolder& run, Pictures& pictures);
std::string inputs_section(const RunFolder& run);
std::string tools_section(const RunFolder& run);

// Report section: causes of the wrong pixels of the held-out views, with pictures.

/// Reads the run's labelled.ply. Empty without labelled.ply, scene or true masks. Order of views as in run.views, worst
/// first; pictures of options.zoomed_views views, table rows of at most 32. With `folder`: writes VIEW.png in full size
/// for every view.
std::string errors_section(const Exec& exec, RunFolder& run, Pictures& pictures, const std::string& folder);

// First section: pictures of the cut object that flip on a click (CSS only), and the boundary set from three sides.

/// Of the views with photo and predicted mask, the one with the median score, or the next one where the object ends
/// before the borders of the picture; null if there is none.
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
