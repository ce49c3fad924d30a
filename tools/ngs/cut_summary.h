#pragma once
// The final output of ngs cut.
#include <string>

#include "cut_chain.h"

namespace ngs::front {

/// About ten lines of text: files, scores, time, warnings and the next step.
std::string summary_of(const CutChain& chain);
/// Instructions for drawing strokes, and the command to continue.
std::string stroke_help(const CutChain& chain);
/// The summary as JSON.
Json summary_json(const CutChain& chain);

}  // namespace ngs::front
