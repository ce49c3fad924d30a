#pragma once
// The section that says where the wrong pixels of the held-out views come from, and shows them.
#include <string>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

/// Reads the run's labelled.ply. Empty without that, a scene or true masks. Views as in run.views, worst first;
/// pictures of as many as options.zoomed_views, tables of at most 32. With `folder`: VIEW.png in full size.
std::string errors_section(const Exec& exec, RunFolder& run, Pictures& pictures, const std::string& folder);

}  // namespace ngs::cli
