#include "ngs/cut/passes/pass.h"
#include "ngs/problem/region.h"

namespace ngs {
namespace {

/// The problem's model as the solution, still without labels.
Solution unoptimised_solution(const PassRun& run) {
  const Problem& problem = *run.problem;
  const BoundarySet boundary = boundary_to_train(problem, run.on("boundary"), run.optimisation.allow_empty);
  return {.cloud = unchanged(problem.cloud), .figures = {{"steps", 0.0}, {"boundary", double(boundary.size())}}};
}

/// Sets the training options that follow from decisions.
void set_training(PassRun& run) {
  JointOptions& joint = run.training.joint;
  for (const Decision& decision : run.decisions.all())
    if (!decision.on) joint.off.emplace(decision.effect->name);
  const bool wanted = run.decisions.switch_of(kJointEffect) == Switch::kOn || run.on(kNerfEffect);
  joint.coarse_contours_follow =
      !wanted && joint.on(kContoursEffect) && joint.on("contour-iterations") && !joint.on("full-resolution");
}

}  // namespace

void begin_optimisation(PassRun& run) {
  Optimisation& at = run.optimisation;
  if (at.tracker) return;
  set_training(run);
  Problem& problem = *run.problem;
  problem.splat.antialiased = problem.splat.antialiased && run.on("antialias");
  // The NeRF is trained against the whole rendering, and moves all Gaussians in it.
  if (!run.on(kNerfEffect) && run.on("boundary")) problem.region = region_of(problem.labels);
  at.tracker.emplace(run.exec, at.tracking, problem, run.budget);
  // Without either no trainer is made: it is as large as the model.
  if (!run.on(kJointEffect) && !run.on(kContoursEffect)) {
    run.solution = unoptimised_solution(run);
    at.tracker->begin([&] {
      Solution start = *run.solution;
      start.labels = problem.labels;
      return start;
    });
    return;
  }
  const TrainingOptions& o = run.training;
  const JointSetup setup{
      .options = o.joint, .sample = o.sample, .rbf = o.rbf, .input = problem, .field = at.field, .losses = o.losses};
  at.trainer = std::make_unique<JointTrainer>(run.exec, run.monitor, setup, at.allow_empty);
  at.tracker->begin([&] { return at.trainer->result(); });
  run.solution = at.trainer->result();
  run.solution->converged = true;
}

}  // namespace ngs
