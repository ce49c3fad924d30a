// The joint NeRF-GS optimisation (Eq. 20) as a pass.
#include <algorithm>
#include <cmath>

#include "ngs/cut/passes/joint/joint_effects.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/pipeline.h"
#include "ngs/problem/region.h"

namespace ngs {
namespace {

class JointPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions&) const override;
  bool follows_clock() const override { return true; }
  void prepare(PassRun& run) override;
  /// Creates the trainer. If the steps are off, its closed-form labels are the solution.
  void begin(PassRun& run) override;
  void run(PassRun& run) override;
  /// Runs the steps that were left to contour iterations, if no iteration ran.
  void finish(PassRun& run) override;
};

/// Notifies the store of the start and the end of the steps.
class StepsNotifier {
 public:
  explicit StepsNotifier(StepStore* store) : store_(store) {
    if (store_ != nullptr) store_->steps_running(true);
  }
  ~StepsNotifier() {
    if (store_ != nullptr) store_->steps_running(false);
  }
  StepsNotifier(const StepsNotifier&) = delete;
  StepsNotifier& operator=(const StepsNotifier&) = delete;

 private:
  StepStore* store_;
};

/// Runs steps until the planned number, the target, a signal, or until `reserve_s` seconds of the budget are left.
/// `store`: null: no checkpoints.
void take_steps(PassRun& run, double reserve_s, StepStore* store) {
  const StepsNotifier notifier(store);
  JointTrainer& trainer = *run.trainer;
  run.tracker->begin_steps(reserve_s, trainer);
  run.log("step " + std::to_string(trainer.steps_done() + 1) + " begins");
  bool ended = run.tracker->target_met();
  while (!trainer.finished() && !ended) {
    const JointProgress progress = trainer.step();
    run.monitor.progress(progress.step, progress.steps);
    ended = run.tracker->after_step(progress, trainer, [&] { return trainer.result(); });
    if (run.monitor.stop_requested()) {
      if (store != nullptr) store->save(trainer);
      return;
    }
    if (store != nullptr && store->save_interval() > 0 && progress.step % store->save_interval() == 0)
      store->try_save(trainer);
  }
}

/// True: neither joint steps nor contours run, so the closed-form labels are the solution.
bool is_unoptimised(const PassRun& run) { return !run.on(kJointEffect) && !run.on(kContoursEffect); }

/// The problem's model as the solution, still without labels.
Solution unoptimised_solution(const PassRun& run) {
  const Problem& problem = *run.problem;
  const BoundarySet boundary = boundary_to_train(problem, run.training.joint.on.boundary, run.allow_empty);
  return {.cloud = unchanged(problem.cloud),
          .source_row = {},
          .labels = {},
          .figures = {{"steps", 0.0}, {"boundary", double(boundary.size())}}};
}

}  // namespace

std::vector<Effect> JointPass::effects() const { return joint_effects(); }

std::vector<FixedDecision> JointPass::fixed_decisions(const TrainingOptions& training) const {
  if (training.joint.steps > 0) return {{kJointEffect, true, "--steps"}};
  return {};
}

void JointPass::prepare(PassRun& run) {
  if (run.budget.is_set()) skip_for_time(run, kNerfEffect);  // smallest gain per second
  run.training.joint.on =
      joint_switches([&](std::string_view name) { return run.decisions.on_if_known(name).value_or(true); });
}

void JointPass::begin(PassRun& run) {
  Problem& problem = *run.problem;
  problem.splat.antialiased = problem.splat.antialiased && run.on("antialias");
  // The NeRF is trained against the whole rendering, and moves all Gaussians in it.
  if (!run.on(kNerfEffect) && run.on("boundary")) problem.region = region_of(problem.labels);
  const TrainingOptions& o = run.training;
  run.tracker.emplace(run.exec, run.tracking, problem, run.budget);
  if (is_unoptimised(run)) {  // saves the memory of a trainer, which is as large as the model
    run.solution = unoptimised_solution(run);
    run.tracker->begin([&] {
      Solution start = *run.solution;
      start.labels = problem.labels;
      return start;
    });
    return;
  }
  run.trainer = std::make_unique<JointTrainer>(
      run.exec, run.monitor, JointSetup{o.joint, o.sample, o.rbf, problem, run.field}, run.allow_empty);
  run.tracker->begin([&] { return run.trainer->result(); });
  run.solution = run.trainer->result();
  run.solution->converged = true;
}

void JointPass::run(PassRun& run) {
  if (run.store != nullptr && run.store->load(*run.trainer))
    run.log("resumed after step " + std::to_string(run.trainer->steps_done()));
  run.solution.reset();  // frees memory: with many objects it is as large as the trainer
  const double share = run.on(kContoursEffect) ? kStepsShare : 1;
  take_steps(run, run.budget.is_set() ? (1 - share) * run.budget.remaining_s() : 0, run.store);
  run.solution = run.trainer->result();
  run.solution->converged = true;
}

void JointPass::finish(PassRun& run) {
  JointOptions all = run.training.joint;
  all.coarse_contours_follow = false;
  const std::int64_t all_steps = steps_of(all, run.problem->views.size());
  const bool too_few =
      run.on(kJointEffect) && run.trainer->steps_done() < all_steps && run.solution->source_row.empty();
  const bool time_left = run.budget.allows(run.tracker->longest_step_s());
  if (too_few && run.on(kContoursEffect) && !run.tracker->target_met() && time_left) {
    run.trainer->plan_steps(all_steps);
    take_steps(run, 0, nullptr);  // no checkpoints: a resumed run refines the contours again
    Solution longer = run.trainer->result();
    longer.figures.merge(run.solution->figures);
    run.solution = std::move(longer);
  }
  if (is_unoptimised(run)) run.solution->labels = run.problem->labels.release();  // last use of the problem's labels
  run.solution->converged = run.tracker->target_met() || (!run.tracker->was_cut() && !run.budget.is_partial());
  const LossTerms& l = run.tracker->last_loss();
  run.report["last_loss"] = {{"total", l.total}, {"photometric", l.photometric},
                             {"align", l.align}, {"mask", l.mask},
                             {"cont", l.cont},   {"smooth", l.smooth}};
}

std::unique_ptr<Pass> make_joint_pass() { return std::make_unique<JointPass>(); }

}  // namespace ngs
