#pragma once
// The final output of ngs cut.
#include <string>

#include "cut_chain.h"

namespace ngs::ngs_tool {

/// About ten lines of text: files, scores, time, warnings and the next step.
std::string summary_of(const CutChain& chain);
/// Instructions for drawing strokes, and a sample of them as one line of JSON.
struct StrokeHelp {
  std::string text, sample;
};
StrokeHelp stroke_help(const CutChain& chain);
/// The command that continues the run, with `further` arguments.
std::string next_line(const CutChain& chain, const std::vector<std::string>& further);
/// What a run leaves that was stopped by a signal.
std::string stopped_text(const CutChain& chain);
/// Text and JSON of a run with --all.
std::string all_text(const CutChain& chain);
Json all_json(const CutChain& chain);
/// The summary as JSON.
Json summary_json(const CutChain& chain);

}  // namespace ngs::ngs_tool
