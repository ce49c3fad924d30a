// The joint NeRF-GS optimisation (Eq. 20) as a pass.
#include <cmath>

#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/training/scene_probe.h"
#include "ngs/problem/scene_measures.h"

namespace ngs {
namespace {

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
  JointTrainer& trainer = *run.optimisation.trainer;
  StepTracker& tracker = *run.optimisation.tracker;
  tracker.begin_steps(reserve_s, trainer);
  run.log("step " + std::to_string(trainer.steps_done() + 1) + " begins");
  bool ended = tracker.target_met();
  while (!trainer.finished() && !ended) {
    const JointProgress progress = trainer.step();
    run.monitor.progress(progress.step, progress.steps);
    ended = tracker.after_step(progress, trainer, [&] { return trainer.result(); });
    if (run.monitor.stop_requested()) {
      if (store != nullptr) store->save(trainer);
      return;
    }
    if (store != nullptr && store->save_interval() > 0 && progress.step % store->save_interval() == 0)
      store->try_save(trainer);
  }
}

class JointPass : public Pass {
 public:
  explicit JointPass(Losses losses)
      : Pass({.stage = PassStage::kOptimise, .follows_clock = true}), losses_(std::move(losses)) {}
  std::vector<Effect> effects() const override {
    std::vector<Effect> effects{
        {.name = kJointEffect,
         .help = "optimise by Eq. 20; off: closed-form labels",
         .saves = "all steps before contour refinement",
         .heuristic = {"gain of agreement with the masks by contour refinement, normal score (0: the photos show edges "
                       "that the model does not, or the masks err to one side)",
                       -kSignificant, "below it the photos add no edge, and refined contours agree less with the masks",
                       [](SceneProbe& probe) { return probe.edge_gain(); }}},
        {.name = "boundary",
         .help = "use the boundary set; off: every seen Gaussian",
         .always = "all other parts work on the set; off is more work, not less"},
        {.name = "sh",
         .help = "use view-dependent colour",
         .saves = "SH bands, their gradients and steps",
         .heuristic = {"strongest view-dependent colour, levels", 0.5, kHalfLevel,
                       [](SceneProbe& probe) {
                         return view_dependence_levels(probe.problem().cloud, probe.sample_cameras(),
                                                       probe.problem().splat.world_unit);
                       }}},
        {.name = "antialias",
         .help = "use the opacity compensation of the model's training",
         .saves = "the compensation",
         .heuristic = {"largest opacity removed by the compensation, levels", 0.5, kHalfLevel,
                       [](SceneProbe& probe) {
                         return antialias_levels(probe.problem().cloud, probe.sample_cameras(), probe.problem().splat);
                       }}},
        {.name = "geometry",
         .help = "move the Gaussians",
         .always = "the gradients exist anyway, and the moved Gaussians are the result"}};
    for (const auto& loss : losses_)
      for (Effect& effect : loss->effects()) effects.push_back(std::move(effect));
    return effects;
  }
  void declare(OptionSet& options, const OptionGroup& given) override {
    OptionGroup group = given;
    group.name = kJointEffect;
    for (const auto& loss : losses_) loss->declare(options, group);
  }
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions& training) const override {
    if (training.joint.steps > 0) return {{kJointEffect, true, "--steps"}};
    if (!preset_of(training.joint.quality).joint) return {{kJointEffect, false, "--quality draft"}};
    return {};
  }
  void run(PassRun& run) override {
    begin_optimisation(run);
    StepStore* const store = run.optimisation.store;
    JointTrainer* const trainer = run.optimisation.trainer.get();
    if (store != nullptr && store->load(*trainer))
      run.log("resumed after step " + std::to_string(trainer->steps_done()));
    run.solution.reset();  // frees memory: with many objects it is as large as the trainer
    const double share = run.on(kContoursEffect) ? kStepsShare : 1;
    take_steps(run, run.budget.is_set() ? (1 - share) * run.budget.remaining_s() : 0, store);
    run.solution = trainer->result();
    run.solution->converged = true;
  }
  /// Without steps the closed-form labels are the solution.
  void finish(PassRun& run) override {
    begin_optimisation(run);
    const StepTracker& tracker = *run.optimisation.tracker;
    if (!trains(run)) run.solution->labels = run.problem->labels.release();  // last use of the problem's labels
    run.solution->converged = tracker.target_met() || (!tracker.was_cut() && !run.budget.is_partial());
    if (!tracker.last_loss().empty()) run.report["last_loss"] = tracker.last_loss();
  }

 private:
  const Losses losses_;  // their options and effects
};

}  // namespace

std::unique_ptr<Pass> make_joint_pass(const Losses& losses) { return std::make_unique<JointPass>(losses); }

}  // namespace ngs
