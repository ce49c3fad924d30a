#pragma once
// Memory estimate of ngs-joint for --dry-run.
#include "ngs/options/option_set.h"
#include "ngs/problem/problem.h"

namespace ngs::joint {

/// Upper bounds in MiB, as if passes used whole views: without and with optimiser steps.
Json memory_plan(const Problem& problem);

}  // namespace ngs::joint
