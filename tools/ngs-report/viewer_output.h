#pragma once
// Where ngs-report writes the 3D page of a run.
#include <string>
#include <vector>

#include "run_folder.h"
#include "shared/run/run.h"
#include "viewer.h"

namespace ngs::cli {

struct ViewerOutput {
  const Output& page;    // the page of the run
  const Output& viewer;  // --viewer; not given: viewer_beside(page)
  const ViewerOptions& options;
};

/// Writes the 3D page of a single run and returns its path. Empty: not written, because there are several runs, no
/// object, no file name (stdout) or --viewer-gaussians 0. An object that cannot be shown is an error with --viewer,
/// else a problem of the run. Throws kUsage if the default path is a file
/// that no ngs-report wrote, without -w.
std::string write_viewer(Run& run, const ViewerOutput& output, std::vector<RunFolder>& runs);

}  // namespace ngs::cli
