#pragma once
// Tracks the steps of a run: writes the trace, tests the target, and ends the steps in time.
#include <optional>
#include <string>

#include "ngs/cut/passes/agreement.h"
#include "ngs/cut/passes/time/budget.h"
#include "ngs/cut/training/joint_trainer.h"

namespace ngs {

struct TrackerOptions {
  std::optional<AgreementTarget> target = {};
  bool traced = false;
  int trace_every = 0;  // steps between scores; 0: at the end of the joint steps and of each contour
                        // iteration, in a few views; with a target once per epoch
};

class StepTracker {
 public:
  StepTracker(const Exec& exec, const TrackerOptions& options, const Problem& problem, const Budget& budget);

  /// Scores the model before the first step and adds it to the trace, without losses.
  void begin(const std::function<Solution()>& result);
  /// Starts to track joint steps, which end when only `reserve_s` seconds of the budget are left.
  void begin_steps(double reserve_s, const JointTrainer& trainer);
  /// Starts to track other steps; of contour iterations, with set_iterations() before the first step. The next
  /// iteration starts only if the time left suffices for a refinement as long as the last one and half of its steps.
  void begin_stage(double reserve_s);
  void set_iterations(int iterations) { iterations_left_ = iterations + 1; }

  /// True: stop, because the target is met or the time is up. `model` returns the current model, for scoring. With a
  /// budget, the trainer's number of steps is adapted to the measured time per step.
  bool after_step(const JointProgress& progress, JointTrainer& trainer, const std::function<Solution()>& model);

  bool target_met() const { return target_met_; }
  /// True: steps were skipped for lack of time.
  bool was_cut() const { return cut_; }
  /// True: the last contour iteration got too few of its steps to gain anything.
  bool too_few_steps() const { return too_few_steps_; }
  /// Of the last step; null: no step was made.
  const Json& last_loss() const { return last_loss_; }
  /// JSON lines (data-schema/trace.schema.json). `t` excludes the time spent on scoring, which is reported separately.
  const std::string& trace() const { return text_; }

 private:
  void score(Json& line, const std::function<Solution()>& model);
  void write_step(const JointProgress& progress, double now_s, const std::function<Solution()>& model);
  void begin_iteration(const JointProgress& first, double now_s);
  void replan(const JointProgress& progress, JointTrainer& trainer);
  bool can_score() const;
  double seconds() const { return budget_.elapsed_s() - scoring_s_; }

  const Exec& exec_;
  const TrackerOptions options_;
  const Problem& problem_;
  const Budget& budget_;
  bool target_met_ = false, cut_ = false, too_few_steps_ = false;
  std::int64_t every_, step_ = 0;
  double scoring_s_ = 0, longest_score_s_ = 0, last_s_ = 0;
  // Of the current joint steps or contour iteration: planned steps without a time limit, step and time at its start,
  // time to leave at its end.
  std::int64_t planned_ = 0, start_step_ = 0;
  double start_s_ = 0, longest_step_s_ = 0, reserve_s_ = 0;
  int iterations_left_ = 0;  // contour iterations left, including the current one; 0: joint steps
  double refine_s_ = 0;
  Json last_loss_;
  std::string text_;
};

}  // namespace ngs
