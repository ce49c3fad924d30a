#include "watch.h"

#include <algorithm>

namespace ngs::joint {

Watch::Watch(const Exec& exec, const RunOptions& options, const MethodInput& input, const Budget& budget,
             bool traced)
    : exec_(exec),
      input_(input),
      budget_(budget),
      target_(parse_target(options.target)),
      traced_(traced),
      every_(options.trace_every > 0 ? options.trace_every : std::int64_t(input.views.size())) {}

void Watch::score(Json& line, const JointTrainer& trainer) {
  const double before = wall_seconds();
  const Agreement agreement = training_agreement(exec_, input_, trainer.result());
  scoring_s_ += wall_seconds() - before;
  target_met_ = target_ && (target_->boundary ? agreement.biou : agreement.iou) >= target_->value;
  line["training_iou"] = agreement.iou, line["training_biou"] = agreement.biou;
  line["scoring_s"] = scoring_s_;
}

bool Watch::begin(const JointTrainer& trainer) {
  if (target_ || traced_) {
    Json line{{"t", seconds()}, {"stage", "start"}, {"step", 0}};
    score(line, trainer);
    if (traced_) text_ += line.dump() + "\n";
  }
  last_s_ = seconds();
  return target_met_;
}

void Watch::replan(const JointProgress& progress, JointTrainer& trainer) {
  if (!budget_.given()) return;
  if (progress.step == 1) planned_ = progress.steps, stage_began_s_ = last_s_;
  const double step_s = (seconds() - stage_began_s_) / double(progress.step);
  const double room = std::max(0.0, budget_.left_s() - 1.2 * longest_step_s_) / step_s;
  const std::int64_t fit = progress.step + std::int64_t(std::min(room, double(planned_)));
  trainer.plan_steps(std::min(planned_, fit));
  late_ = trainer.finished() && progress.step < planned_;
}

bool Watch::after_step(std::string_view stage, const JointProgress& progress, JointTrainer& trainer) {
  const LossTerms& l = last_loss_ = progress.loss;
  ++step_;
  const double now = seconds();
  longest_step_s_ = std::max(longest_step_s_, now - last_s_);
  if (target_ || traced_) {
    Json line{{"t", now},
              {"stage", stage},
              {"step", step_},
              {"view", input_.scene.views[progress.view].camera.name},
              {"loss",
               {{"total", l.total},
                {"photometric", l.photometric},
                {"align", l.align},
                {"mask", l.mask},
                {"cont", l.cont},
                {"smooth", l.smooth}}}};
    if (step_ % every_ == 0 || progress.step == progress.steps) score(line, trainer);
    if (traced_) text_ += line.dump() + "\n";
  }
  replan(progress, trainer);
  last_s_ = seconds();
  late_ |= !budget_.allows(1.2 * longest_step_s_);
  return target_met_ || late_;
}

}  // namespace ngs::joint
