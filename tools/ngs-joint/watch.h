#pragma once
// What goes with the steps of a run: the trace, the target and the time.
#include "budget.h"
#include "joint_run.h"

namespace ngs::joint {

class Watch {
 public:
  Watch(const Exec& exec, const RunOptions& options, const MethodInput& input, const Budget& budget,
        bool traced);

  /// The model before the first step: a line of the trace without losses. True: the target is met already.
  bool begin(const JointTrainer& trainer);
  /// True: no further step, because the target is met or the time is up.
  /// Under a budget the trainer's plan follows the time that its steps turn out to take.
  bool after_step(std::string_view stage, const JointProgress& progress, JointTrainer& trainer);

  bool target_met() const { return target_met_; }
  bool late() const { return late_; }
  const LossTerms& last_loss() const { return last_loss_; }
  /// JSON lines (data-schema/trace.schema.json). Time spent on scoring is kept out of `t` and stated apart.
  const std::string& trace() const { return text_; }

 private:
  void score(Json& line, const JointTrainer& trainer);
  void replan(const JointProgress& progress, JointTrainer& trainer);
  double seconds() const { return budget_.elapsed_s() - scoring_s_; }

  const Exec& exec_;
  const MethodInput& input_;
  const Budget& budget_;
  std::optional<Target> target_;
  bool traced_, target_met_ = false, late_ = false;
  std::int64_t every_, step_ = 0, planned_ = 0;  // planned_: steps of this stage, before time ran short
  double scoring_s_ = 0, last_s_ = 0, longest_step_s_ = 0, stage_began_s_ = 0;
  LossTerms last_loss_;
  std::string text_;
};

}  // namespace ngs::joint
