#pragma once
// The steps of ngs cut: names for people, tools, files and expected times.
#include <string>
#include <vector>

#include "cut_inputs.h"
#include "cut_options.h"

namespace ngs::ngs_tool {

struct PlannedStep {
  std::string name;         // of the stage, as for StageRunner
  std::string words;        // what is done: "sharpening the edge"
  std::string tool;         // "ngs-joint"; "ngs cut": in this process
  std::string files;        // what it writes, relative to the output folder
  double share = 1;         // expected time in seconds, of a small splat
  bool has_passes = false;  // its progress restarts
};

struct PlanFacts {
  bool marked = false;           // there are strokes
  bool has_masks = false;        // of the scene, of the capture, or given
  bool reuses_pictures = false;  // of an earlier run
};

/// In the order in which they run.
std::vector<PlannedStep> planned_steps(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts);

/// A table of the steps: number, words, tool, files.
std::string plan_text(const std::vector<PlannedStep>& steps, const std::string& out);

}  // namespace ngs::ngs_tool
