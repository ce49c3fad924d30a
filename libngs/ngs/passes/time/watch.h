#pragma once
// What goes with the steps of a run: the trace, the target and the clock.
#include <optional>
#include <string>

#include "ngs/passes/agreement.h"
#include "ngs/stages/optimise/joint_trainer.h"
#include "ngs/passes/time/budget.h"

namespace ngs {

struct WatchOptions {
  std::optional<AgreementTarget> target = {};
  bool traced = false;
  int trace_every = 0;  // steps between scores; 0: once per epoch
};

class Watch {
 public:
  Watch(const Exec& exec, const WatchOptions& options, const Problem& problem, const Budget& budget);

  /// The model before the first step: a line of the trace without losses.
  void begin(const std::function<Solution()>& result);
  /// The steps to come, from where the trainer is, go on until only `keep_s` of the budget are left.
  void begin_steps(double keep_s, const JointTrainer& trainer);
  /// The same for contour iterations. Another begins where the time left allows a refinement as long as the last one,
  /// and half of the last one's steps.
  void begin_iterations(double keep_s);
  /// How many there will be, known after the first refinement.
  void iterations_known(int iterations) { iterations_left_ = iterations + 1; }

  /// True: no further step, because the target is met or the time is up. `whole` gives the model as it is, for scoring.
  /// Under a budget the trainer's plan follows the time that its steps turn out to take.
  bool after_step(const JointProgress& progress, JointTrainer& trainer, const std::function<Solution()>& whole);

  bool target_met() const { return target_met_; }
  /// Steps were left out for want of time.
  bool cut() const { return cut_; }
  double longest_step_s() const { return longest_step_s_; }
  const LossTerms& last_loss() const { return last_loss_; }
  /// JSON lines (data-schema/trace.schema.json). Time spent on scoring is kept out of `t` and stated by itself.
  const std::string& trace() const { return text_; }

 private:
  void score(Json& line, const std::function<Solution()>& whole);
  void write_step(const JointProgress& progress, double now_s, const std::function<Solution()>& whole);
  void begin_stage(double keep_s);
  void begin_iteration(const JointProgress& first, double now_s);
  void replan(const JointProgress& progress, JointTrainer& trainer);
  bool score_fits() const;
  double seconds() const { return budget_.elapsed_s() - scoring_s_; }

  const Exec& exec_;
  const WatchOptions options_;
  const Problem& problem_;
  const Budget& budget_;
  bool target_met_ = false, cut_ = false;
  std::int64_t every_, step_ = 0;
  double scoring_s_ = 0, longest_score_s_ = 0, last_s_ = 0;
  // Of the steps or the iteration that runs: its steps before time ran short; when it began, at which step; the time
  // that it must leave.
  std::int64_t planned_ = 0, began_step_ = 0;
  double began_s_ = 0, longest_step_s_ = 0, keep_s_ = 0;
  int iterations_left_ = 0;  // of contours, this one included; 0: these are joint steps
  double refine_s_ = 0;
  LossTerms last_loss_;
  std::string text_;
};

}  // namespace ngs
