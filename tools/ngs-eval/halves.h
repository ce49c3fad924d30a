#pragma once
// ngs-eval --halves: scores object.ply and background.ply against the folder of ngs-synth --truth halves.
#include <string>

#include "evaluation.h"

namespace ngs::cli {

struct HalvesInput {
  std::string cut;     // folder with object.ply, background.ply or both
  std::string truth;   // folder with object/ and background/
  std::string model;   // the uncut model; empty: none
  std::string output;  // metrics.json
};

/// Throws kUsage for options that contradict --halves; warns about unused ones, also of a run without --halves.
void check_halves_options(Run& run, const EvalOptions& options, const EvalFileOptions& files);

/// Scores the models of the folder, writes the output and shows a table.
void score_halves(Run& run, const HalvesInput& input);

}  // namespace ngs::cli
