#pragma once
// Executes a run, from the checks of its paths to its report.
#include <functional>

#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"
#include "shared/run/console.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// Returns the exit code of the body.
int execute(Spec& spec, const CommonFlags& flags, Console& console, const std::function<int(Run&)>& body);

}  // namespace ngs::cli
