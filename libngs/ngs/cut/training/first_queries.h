#pragma once
// Query points for the first step of a view, sampled from the initial model (C23).
#include "ngs/cut/training/joint_field.h"
#include "ngs/problem/problem.h"

namespace ngs {

/// [N] 1: in the boundary set of some object. If `boundary_effect` is false: seen by some view.
std::vector<float> boundary_flags(const Problem& input, bool boundary_effect);

/// Validates a field written by ngs-sample. kBadInput: it does not have the nodes of every grid in order, each with
/// pixel and depth. kInconsistent: it is relative to another origin. `name`: of the file, for messages.
void require_grids(const QueryField& field, const GaussianCloud& cloud, const std::string& name);

struct FirstQueries {
  const Exec& exec;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const Problem& input;
  const SplatOptions& splat;  // of input.cloud
  bool boundary_effect;
  const QueryField* given;  // query points read from a file; null: sampled here
  const JointField& field;

  /// Rays of the scene's view `v`. kInconsistent: the given field lacks the view.
  FieldRays rays(std::size_t v) const;
};

}  // namespace ngs
