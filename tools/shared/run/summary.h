#pragma once
// What a run ends with where people read it: what was made, how long it took, scores, what was odd, and what comes
// next. The report has all of it and more.
#include <string>

#include "shared/cli/spec.h"

namespace ngs::cli {

/// At most ten lines. `report`: of a run that ended well (run/report.h).
/// Within a chain (NGS_STAGE_OF, such as 3/9) one line: the chain has its own end.
std::string summary_text(const Spec& spec, const Json& report);

/// "3/9", the place of this run in a chain; empty where it is in none.
std::string stage_of_chain();

/// "12.3 s", "4 min 5 s", "2 h 7 min".
std::string duration_text(double seconds);

}  // namespace ngs::cli
