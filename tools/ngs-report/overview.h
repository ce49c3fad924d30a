#pragma once
// The first thing on the page: what was cut out, as pictures that flip on a click (CSS only), and where the
// boundary set lies, from three sides.
#include <string>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

/// The view in the middle of the scored ones that can be shown; null if none can.
const ShownView* median_view(const RunFolder& run);

/// Photo and object, photo and background, input mask and result; each as far as the run has the files.
/// Pictures of median_view(), opening on the object. `viewer`: where a page of it in 3D lies, as HTML takes addresses,
/// or empty. Empty without photo and mask.
std::string overview_section(const Exec& exec, RunFolder& run, Pictures& pictures, const std::string& viewer);

/// The Gaussians of labelled.ply along the world's axes. Empty without it or without a boundary set.
std::string boundary_section(RunFolder& run, Pictures& pictures);

/// The command line of every tool, from reports/TOOL.sh.
std::string repeat_section(const RunFolder& run);

}  // namespace ngs::cli
