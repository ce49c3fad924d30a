#pragma once
// The memory of ngs-joint, foreseen for --dry-run.
#include "ngs/options/option_set.h"
#include "ngs/problem/problem.h"

namespace ngs::joint {

/// MiB at most, as if passes went over whole views: of labels alone, and of a run that takes steps.
Json memory_plan(const Problem& problem);

}  // namespace ngs::joint
