#pragma once
// The first thing on the page: what was cut out, as pictures that flip on a click (CSS only), and where the
// boundary set lies, from three sides.
#include <string>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

/// Photo and object, photo and background, input mask and result; each as far as the run has the files.
/// Pictures of the view with the median boundary IoU. Empty without photo and mask.
std::string overview_section(const Exec& exec, RunFolder& run, Pictures& pictures);

/// The Gaussians of labelled.ply along the world's axes. Empty without it or without a boundary set.
std::string boundary_section(RunFolder& run, Pictures& pictures);

/// The command line of every tool, from reports/TOOL.sh.
std::string repeat_section(const RunFolder& run);

}  // namespace ngs::cli
