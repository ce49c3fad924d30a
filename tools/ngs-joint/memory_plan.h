#pragma once
// What --dry-run says about memory.
#include "ngs/problem/problem.h"
#include "options.h"

namespace ngs::joint {

/// Bytes per Gaussian, per pixel of a photo, per view and per object, and the peak that follows from them: the most of
/// what is in memory at once, with everything in windows as large as the views. Nothing but headers is read for it.
Json memory_plan(const Options& options, const Problem& problem);

}  // namespace ngs::joint
