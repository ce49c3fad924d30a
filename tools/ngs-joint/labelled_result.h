#pragma once
// Labels of the input model, and the result file.
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/options/option_set.h"
#include "ngs/problem/problem.h"
#include "shared/tool.h"

namespace ngs::joint {

/// Moves the label columns out of `ply`, one set per object of the scene. Throws kBadInput if some are missing.
std::vector<LabelColumns> take_labels(io::GaussianPly& ply, const Scene& scene);

struct ResultSource {
  const io::GaussianPly& ply;
  const Scene& scene;
  const SharedLabels& labels;         // as read from the file
  const std::vector<float>& floater;  // [N] 1: removed as a floater; empty: none was removed
};

/// Writes the labelled PLY and adds the figures of the method to the report.
void write_result(cli::Run& run, const ResultSource& source, const Solution& solution, const std::string& path);

// Memory estimate of ngs-joint for --dry-run.

/// Upper bounds in MiB, as if passes used whole views: without and with optimiser steps.
Json memory_plan(const Problem& problem);

}  // namespace ngs::joint
