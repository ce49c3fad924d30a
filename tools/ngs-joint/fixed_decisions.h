#pragma once
// What decides effects before any detector does: the method, options, and another run's report.
#include <string>
#include <vector>

#include "options.h"

namespace ngs::joint {

/// `effects_from`: a report of ngs-joint whose decisions are taken over where nothing
/// else rules, or empty; kBadInput if it holds none, kInconsistent if it is another method's.
std::vector<FixedDecision> fixed_decisions_of(const Options& options, const std::string& effects_from);

}  // namespace ngs::joint
