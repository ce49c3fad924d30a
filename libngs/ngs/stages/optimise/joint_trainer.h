#pragma once
// The joint NeRF-GS optimisation: labels, Gaussians and the field, one training view per step.
//                                                                     Eqs. (1)-(2), (10)-(20), Algorithm 1
//                                                                     step 6
// Query points: the first visit of a view uses those of the initial model (the artifact of ngs-sample and
// ngs-rbf, if given: the same), every later visit those of the model as it is (C23). Views come in a new
// order every round.
#include <memory>

#include "ngs/stages/optimise/joint_field.h"
#include "ngs/problem/problem.h"

namespace ngs {

/// The terms of Eq. (20) and the photometric anchor, each unweighted.
struct LossTerms {
  double photometric = 0, align = 0, mask = 0, cont = 0, smooth = 0, total = 0;
};

struct JointProgress {
  std::int64_t step = 0, steps = 0;  // done, planned
  std::size_t view = 0;              // the view of the last step
  LossTerms loss;
};

/// A named array of the trainer's state: what a checkpoint holds.
struct StateBlock {
  std::string name;
  std::vector<float>* values;
  std::size_t size;           // that the values have to have
  bool may_be_empty = false;  // moments before their first step
  bool fits(std::size_t count) const { return count == size || (may_be_empty && count == 0); }
};

struct JointSetup {
  const JointOptions& options;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const Problem& input;
  const QueryField* field = nullptr;  // of the initial model; null: sampled here
  GaussianRates rates = {};
  std::vector<std::uint8_t> frozen = {};  // [N] 1: shape, opacity and colour stay; empty: input.frozen
};

/// What is boundary before the first step. kNothingFound where no usable Gaussian is (allow with
/// `empty_boundary_is_fine`: labels are trained alone).
BoundarySet boundary_to_train(const Problem& input, bool boundary_effect, bool empty_boundary_is_fine);

class JointTrainer {
 public:
  /// Throws as boundary_to_train().
  JointTrainer(const Exec& exec, Monitor& monitor, const JointSetup& setup, bool empty_boundary_is_fine);
  ~JointTrainer();

  bool finished() const;
  /// Another number of steps in all; the rates go on falling towards that end. At least those that are done.
  void plan_steps(std::int64_t steps);
  JointProgress step();
  std::int64_t steps_done() const;
  std::int64_t steps_planned() const;
  Solution result() const;
  /// Of the result.
  std::map<std::string, double> figures() const;

  /// Everything that changes from step to step, by name; a copy of it and the step number resume byte for
  /// byte.
  std::vector<StateBlock> state();
  void resume_at(std::int64_t step);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ngs
