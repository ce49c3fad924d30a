#pragma once
// The summary of a run on a terminal: outputs, time, scores, number of warnings and the next command. The report has
// all of it and more.
#include <string>

#include "shared/cli/spec.h"

namespace ngs::cli {

/// At most ten lines. `report`: of a run that succeeded (run/report.h). Within a chain (NGS_STAGE_OF, such as 3/9) it
/// is one line, because the chain prints its own summary.
std::string summary_text(const Spec& spec, const Json& report);

/// "3/9": this run is stage 3 of a chain of 9; empty outside a chain.
std::string stage_of_chain();

/// "12.3 s", "4 min 5 s", "2 h 7 min".
std::string duration_text(double seconds);

}  // namespace ngs::cli
