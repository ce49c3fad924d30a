#pragma once
// What ngs cut says at its end.
#include <string>

#include "cut_chain.h"

namespace ngs::front {

/// About ten lines for people: what was made, how good it is, how long it took, what was odd, what to do next.
std::string summary_of(const CutChain& chain);
/// What to paint on, and the command that goes on.
std::string stroke_help(const CutChain& chain);
/// The same for programs.
Json summary_json(const CutChain& chain);

}  // namespace ngs::front
