#pragma once
// Report section: causes of the wrong pixels of the held-out views, with pictures.
#include <string>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

/// Reads the run's labelled.ply. Empty without labelled.ply, scene or true masks. Order of views as in run.views, worst
/// first; pictures of options.zoomed_views views, table rows of at most 32. With `folder`: writes VIEW.png in full size
/// for every view.
std::string errors_section(const Exec& exec, RunFolder& run, Pictures& pictures, const std::string& folder);

}  // namespace ngs::cli
