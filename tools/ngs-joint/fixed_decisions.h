#pragma once
// Decisions on effects that need no heuristic: from the method, from options, and from another run's report.
#include <string>
#include <vector>

#include "options.h"

namespace ngs::joint {

/// `effects_from`: empty, or a report of ngs-joint whose decisions are repeated unless the method or an option fixes
/// them. Throws kBadInput if the report has no decisions, kInconsistent if it belongs to another method.
std::vector<FixedDecision> fixed_decisions_of(const Options& options, const std::string& effects_from);

}  // namespace ngs::joint
