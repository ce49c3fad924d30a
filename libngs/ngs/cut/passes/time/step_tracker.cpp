#include "ngs/cut/passes/time/step_tracker.h"

#include <algorithm>

namespace ngs {
namespace {

/// Minimum share of its steps with which an iteration begins (decision 031).
constexpr double kMinShare = 0.5;
/// Epochs that an iteration needs to gain anything: after one, split Gaussians do not fit the photos yet (decision
/// 075).
constexpr std::int64_t kMinEpochs = 2;
/// Views of a score that decides nothing: a trace must not cost more than 2 % of a run.
constexpr std::size_t kTracedViews = 8;

Json json_of(const LossValues& loss) {
  Json json{{"total", loss.total}};
  for (const auto& [column, value] : loss.terms) json[std::string(column)] = value;
  return json;
}

}  // namespace

StepTracker::StepTracker(const Exec& exec, const TrackerOptions& options, const Problem& problem, const Budget& budget)
    : exec_(exec),
      options_(options),
      problem_(problem),
      budget_(budget),
      every_(options.trace_every > 0 ? options.trace_every
             : options.target        ? std::int64_t(problem.views.size())
                                     : 0) {}

void StepTracker::score(Json& line, const std::function<Solution()>& model) {
  const std::optional<Monitor::Scope> timed =
      problem_.monitor != nullptr ? std::optional<Monitor::Scope>(std::in_place, *problem_.monitor, "score")
                                  : std::nullopt;
  const double before = wall_seconds();
  const Agreement agreement =
      mean_agreement(training_agreement(exec_, problem_, model(), every_ > 0 ? 0 : kTracedViews));
  const double took_s = wall_seconds() - before;
  scoring_s_ += took_s;
  longest_score_s_ = std::max(longest_score_s_, took_s);
  const std::optional<AgreementTarget>& target = options_.target;
  target_met_ = target && (target->boundary ? agreement.biou : agreement.iou) >= target->value;
  line["training_iou"] = agreement.iou;
  line["training_biou"] = agreement.biou;
  line["scoring_s"] = scoring_s_;
}

void StepTracker::begin(const std::function<Solution()>& result) {
  if (options_.target || options_.traced) {
    Json line{{"t", seconds()}, {"stage", "start"}, {"step", 0}};
    if (can_score()) score(line, result);
    if (options_.traced) text_ += line.dump() + "\n";
  }
  last_s_ = seconds();
}

void StepTracker::begin_stage(double reserve_s) {
  iterations_left_ = 0;
  reserve_s_ = reserve_s;
  too_few_steps_ = false;
  last_s_ = start_s_ = seconds();
  longest_step_s_ = 0;
}

void StepTracker::begin_steps(double reserve_s, const JointTrainer& trainer) {
  begin_stage(reserve_s);
  planned_ = trainer.steps_planned();
  step_ = start_step_ = trainer.steps_done();
}

/// Called after the first step of an iteration. The time before that step was the refinement.
void StepTracker::begin_iteration(const JointProgress& first, double now_s) {
  refine_s_ = now_s - last_s_;
  --iterations_left_;
  planned_ = first.steps;
  start_step_ = first.step;
  start_s_ = last_s_ = now_s;
  longest_step_s_ = 0;
}

/// Scoring cannot be interrupted, so the longest score so far and the longest step must fit.
bool StepTracker::can_score() const { return budget_.allows(reserve_s_ + 1.2 * (longest_score_s_ + longest_step_s_)); }

void StepTracker::replan(const JointProgress& progress, JointTrainer& trainer) {
  if (!budget_.is_set() || progress.step == start_step_) return;
  const double step_s = (seconds() - start_s_) / double(progress.step - start_step_);
  const double more = std::max(0.0, budget_.remaining_s() - reserve_s_ - 1.2 * longest_step_s_) / step_s;
  trainer.plan_steps(std::min(planned_, progress.step + std::int64_t(std::min(more, double(planned_)))));
}

void StepTracker::write_step(const JointProgress& progress, double now_s, const std::function<Solution()>& model) {
  if (!options_.target && !options_.traced) return;
  Json line{{"t", now_s},
            {"stage", iterations_left_ > 0 ? "contours" : "joint"},
            {"step", step_},
            {"view", problem_.scene.views[progress.view].camera.name},
            {"loss", json_of(progress.loss)}};
  if (((every_ > 0 && step_ % every_ == 0) || progress.step == progress.steps) && can_score()) score(line, model);
  if (options_.traced) text_ += line.dump() + "\n";
}

bool StepTracker::after_step(const JointProgress& progress, JointTrainer& trainer,
                             const std::function<Solution()>& model) {
  last_loss_ = json_of(progress.loss);
  ++step_;
  const double now = seconds();
  if (iterations_left_ > 0 && progress.step == 1) begin_iteration(progress, now);
  longest_step_s_ = std::max(longest_step_s_, now - last_s_);
  write_step(progress, now, model);
  replan(progress, trainer);
  last_s_ = seconds();
  bool over = !budget_.allows(reserve_s_ + 1.2 * longest_step_s_);
  if (iterations_left_ > 1 && trainer.finished())
    over |= !budget_.allows(reserve_s_ + refine_s_ + kMinShare * (last_s_ - start_s_));
  cut_ |= (over || trainer.finished()) && (progress.step < planned_ || (over && iterations_left_ > 1));
  too_few_steps_ = !target_met_ && progress.step < std::min(planned_, kMinEpochs * progress.epoch_steps);
  return target_met_ || over;
}

}  // namespace ngs
