#pragma once
// The joint NeRF-GS optimisation of labels, Gaussians and the field, one training view per step.
//                                                              Eqs. (1)-(2), (10)-(20), Algorithm 1 step 6
// The first step of a view uses query points of the initial model, read from a file of ngs-sample and ngs-rbf if one is
// given. Later steps sample them from the current model (C23). Every round over the views has a new random order.
#include <memory>

#include "ngs/cut/training/joint_field.h"
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

/// A named array of the trainer's state, for checkpoints.
struct StateBlock {
  std::string name;
  std::vector<float>* values;
  std::size_t size;           // required number of values
  bool may_be_empty = false;  // true for moments, which are empty before the first step
  bool fits(std::size_t count) const { return count == size || (may_be_empty && count == 0); }
};

struct JointSetup {
  const JointOptions& options;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const Problem& input;
  const QueryField* field = nullptr;  // query points of the initial model; null: sampled here
  GaussianRates rates = {};
  std::vector<std::uint8_t> frozen = {};  // [N] 1: only the label is trained; empty: input.frozen
};

/// The boundary set before the first step. kNothingFound: the set is empty, unless `allow_empty`; then only
/// labels are trained.
BoundarySet boundary_to_train(const Problem& input, bool boundary_effect, bool allow_empty);

class JointTrainer {
 public:
  /// Throws as boundary_to_train().
  JointTrainer(const Exec& exec, Monitor& monitor, const JointSetup& setup, bool allow_empty);
  ~JointTrainer();

  bool finished() const;
  /// Changes the total number of steps; the rates decay towards the new end. At least the steps already done.
  void plan_steps(std::int64_t steps);
  JointProgress step();
  std::int64_t steps_done() const;
  std::int64_t steps_planned() const;
  Solution result() const;
  /// Figures of the result.
  std::map<std::string, double> figures() const;

  /// All arrays that change between steps. Restoring them and the step number resumes bit-identically.
  std::vector<StateBlock> state();
  void resume_at(std::int64_t step);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ngs
