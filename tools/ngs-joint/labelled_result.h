#pragma once
// Labels of the model that was read, and of the one that is written.
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/problem/problem.h"
#include "shared/tool.h"

namespace ngs::joint {

/// The model's label columns, one per object of the scene, which `ply` then has no more; kBadInput where they are
/// missing.
std::vector<LabelColumns> take_labels(io::GaussianPly& ply, const Scene& scene);

/// What a result is written on top of.
struct ResultSource {
  const io::GaussianPly& ply;
  const Scene& scene;
  const SharedLabels& labels;         // as they were read
  const std::vector<float>& floater;  // [N] 1: taken out; empty: none was
};

/// The labelled PLY, and the figures of a finished method into the report.
void write_result(cli::Run& run, const ResultSource& source, const Solution& solution, const std::string& path);

}  // namespace ngs::joint
