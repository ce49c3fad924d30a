#pragma once
// The query points of a view's first visit: those of the initial model (C23).
#include "ngs/stages/optimise/joint_field.h"
#include "ngs/problem/problem.h"

namespace ngs {

/// [N] 1: boundary of any object, or, without the effect, seen by any view.
std::vector<float> boundary_flags(const Problem& input, bool boundary_effect);

/// kBadInput where `field` is not what ngs-sample writes: the nodes of every grid in order, each with its pixel and
/// depth. kInconsistent where it is relative to another origin. `name` is the file's.
void require_grids(const QueryField& field, const GaussianCloud& cloud, const std::string& name);

struct FirstQueries {
  const Exec& exec;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const Problem& input;
  bool boundary_effect;
  const QueryField* given;  // of the initial model; null: sampled here
  const JointField& field;

  /// `v`: of the scene. kInconsistent where the given field lacks it.
  FieldRays rays(std::size_t v) const;
};

}  // namespace ngs
