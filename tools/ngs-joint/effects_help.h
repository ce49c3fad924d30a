#pragma once
// The table of effects in the help: passes, their parts, and the mode of each where --effect says nothing.
#include <string>

#include "options.h"

namespace ngs::joint {

/// Of the passes that run with the method of `options`. `in_full`: a line for each part too, not only its name.
std::string effects_help(const Options& options, bool in_full);

}  // namespace ngs::joint
