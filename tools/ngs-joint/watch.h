#pragma once
// What goes with the steps of a run: the trace, the target and the time.
#include "budget.h"
#include "joint_run.h"

namespace ngs::joint {

class Watch {
 public:
  Watch(const Exec& exec, const RunOptions& options, const Problem& input, const Budget& budget,
        bool traced);

  /// The model before the first step: a line of the trace without losses. True: the target is met already.
  bool begin(const JointTrainer& trainer);
  /// The steps to come, from where the trainer is, go on until only `keep_s` of the budget are left.
  void begin_steps(double keep_s, const JointTrainer& trainer);
  /// The same for iterations of edges. Another is begun where what is left has room for its walk and half of its steps.
  void begin_iterations(double keep_s);
  /// How many there may be, known after the first walk; a step of those before the last takes `early_share` of one of it.
  void iterations_known(int iterations, double early_share) { iterations_left_ = iterations + 1, early_share_ = early_share; }

  /// True: no further step, because the target is met or the time is up.
  /// `whole` gives the model as it is, for scoring. Under a budget the trainer's plan follows the time that its steps turn out to take.
  bool after_step(const JointProgress& progress, JointTrainer& trainer, const std::function<Solution()>& whole);

  bool target_met() const { return target_met_; }
  /// Steps were left out for want of time.
  bool cut() const { return cut_; }
  const LossTerms& last_loss() const { return last_loss_; }
  /// JSON lines (data-schema/trace.schema.json). Time spent on scoring is kept out of `t` and stated apart.
  const std::string& trace() const { return text_; }

 private:
  void score(Json& line, const std::function<Solution()>& whole);
  void begin_stage(double keep_s);
  void begin_iteration(const JointProgress& first, double now_s);
  void replan(const JointProgress& progress, JointTrainer& trainer);
  bool next_iteration_fits(const JointProgress& progress) const;
  double step_s(const JointProgress& progress) const;
  bool score_fits() const;
  double seconds() const { return budget_.elapsed_s() - scoring_s_; }

  const Exec& exec_;
  const Problem& input_;
  const Budget& budget_;
  std::optional<Target> target_;
  bool traced_, target_met_ = false, cut_ = false;
  std::int64_t every_, step_ = 0;
  double scoring_s_ = 0, longest_score_s_ = 0, last_s_ = 0;
  // Of the stage or iteration that runs: its steps before time ran short; when it began, at which step; what it
  // leaves of the budget.
  std::int64_t planned_ = 0, began_step_ = 0;
  double began_s_ = 0, longest_step_s_ = 0, keep_s_ = 0;
  int iterations_left_ = 0;  // of edges, this one included; 0: these are not edges
  double refine_s_ = 0, early_share_ = 1;
  LossTerms last_loss_;
  std::string text_;
};

}  // namespace ngs::joint
