#pragma once
// The joint optimisation of labels and Gaussians by the losses of a list, one training view per step. Every round over
// the views has a new random order.                                                Eqs. (2), (20), Algorithm 1 step 6
#include <memory>

#include "ngs/cut/training/loss_list.h"
#include "ngs/cut/training/loss_term.h"
#include "ngs/problem/problem.h"

namespace ngs {

struct JointProgress {
  std::int64_t step = 0, steps = 0;  // done, planned
  std::int64_t epoch_steps = 0;      // one for each trained view
  std::size_t view = 0;              // the view of the last step
  LossValues loss;
};

struct JointSetup {
  const JointOptions& options;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const Problem& input;
  const QueryField* field = nullptr;  // query points of the initial model; null: sampled here
  GaussianRates rates = {};
  std::vector<std::uint8_t> frozen = {};  // [N] 1: only the label is trained; empty: input.frozen
  Losses losses = all_losses();           // the trainer uses copies of those that are on
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

  /// All arrays that change between steps. Restoring them and the step number resumes bit-identically.
  std::vector<StateBlock> state();
  void resume_at(std::int64_t step);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ngs
