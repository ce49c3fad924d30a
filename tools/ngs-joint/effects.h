#pragma once
// The effects of a run: decisions that need no heuristic, and the table in the help.
#include <string>
#include <vector>

#include "options.h"

namespace ngs::joint {

/// Decisions from the method, from options, and from another run's report. `effects_from`: empty, or a report of
/// ngs-joint whose decisions are repeated unless the method or an option fixes them. Throws kBadInput if the report has
/// no decisions, kInconsistent if it belongs to another method.
std::vector<FixedDecision> fixed_decisions_of(const Options& options, const std::string& effects_from);

/// The table for the passes that run with the method of `options`. `in_full`: also one line per part.
std::string effects_help(const Options& options, bool in_full);

}  // namespace ngs::joint
