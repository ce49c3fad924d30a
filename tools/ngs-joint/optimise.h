#pragma once
// The loop of ngs-joint --method paper, and what it shares with the methods beside it.
#include <string>
#include <vector>

#include "joint_run.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/passes/contours/contour_stage.h"

namespace ngs::joint {

struct Settings {
  RunOptions run;
  JointOptions joint;
  ContourOptions edge;
  SampleOptions sample;
  RbfOptions rbf;
};

/// The options that change the result, as one line of JSON.
std::string options_text(Settings settings);

/// The model's label columns, one per object of the scene; kBadInput where they are missing.
std::vector<LabelColumns> labels_of(const io::GaussianPly& ply, const Scene& scene);

/// What a result is written on top of.
struct Source {
  const io::GaussianPly& ply;
  const Scene& scene;
  const std::vector<float>& floater;  // [N] 1: taken out; empty: none was
};

/// The labelled PLY and the figures of a finished method.
void write_result(cli::Run& run, const Source& source, const Solution& result, const std::string& path);

class Budget;
class Decisions;

struct JointJob {
  const Problem& input;
  const QueryField* field;
  Source source;
  Checkpoint checkpoint;
  Budget& budget;
};
struct Artifacts {
  std::string labelled, nerf, trace;  // empty: not wanted
};

/// Steps until the end, the budget, the target or a signal. Returns the exit code.
int optimise(cli::Run& run, Decisions& decisions, const JointJob& problem, const Artifacts& artifacts);

}  // namespace ngs::joint
