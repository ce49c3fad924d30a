#pragma once
// The table of effects in the help: passes, their parts, and the default switch of each.
#include <string>

#include "options.h"

namespace ngs::joint {

/// The table for the passes that run with the method of `options`. `in_full`: also one line per part.
std::string effects_help(const Options& options, bool in_full);

}  // namespace ngs::joint
