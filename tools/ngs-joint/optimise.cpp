#include "optimise.h"

#include <algorithm>

#include "decide.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/passes/contours/refined_masks.h"
#include "ngs/passes/effect_detectors.h"
#include "shared/checkpoints.h"
#include "watch.h"

namespace ngs::joint {
std::string options_text(Settings settings) {
  OptionSet set;
  set.add(settings.joint);
  set.add(settings.edge);
  set.add(settings.sample);
  set.add(settings.rbf);
  return set.to_json().dump();
}

std::vector<LabelColumns> labels_of(const io::GaussianPly& ply, const Scene& scene) {
  const std::size_t wanted = scene.objects.size();
  if (ply.cloud.size() == 0)
    throw Error(ErrorCode::kNothingFound, ply.file.name() + ": the model has no Gaussians, expected some",
                "label one that has: ngs-variance scene.json -o boundary.ply");
  // Beside the sets of several objects the unsuffixed one is their union.
  if (wanted == 1 && ply.objects.empty() && !ply.labels.label.empty() && !ply.labels.boundary.empty() && !ply.labels.views.empty() &&
      !ply.labels.prob.empty()) {
    const std::string& name = scene.objects[0].name;
    if (ply.names_object && ply.object != name)
      throw Error(ErrorCode::kInconsistent, ply.file.name() + ": labelled for object '" + ply.object + "', expected '" + name + "'",
                  "label that one: ngs-variance scene.json --object NAME -o boundary.ply");
    return {ply.labels};
  }
  std::vector<LabelColumns> labels;
  for (const SceneObject& object : scene.objects)
    for (const io::NamedLabels& named : ply.objects)
      if (named.object == object.name) labels.push_back(named.columns);
  if (labels.size() != wanted)
    throw Error(ErrorCode::kBadInput,
                "the model has ngs_ columns for " + std::to_string(labels.size()) + " of the scene's " +
                    std::to_string(wanted) + " objects, expected all of them",
                ply.names_object ? "it is labelled for one: --objects '" + ply.object + "'"
                                 : "label it first: ngs-variance scene.json -o boundary.ply");
  return labels;
}

void write_result(cli::Run& run, const Source& source, const Solution& result, const std::string& path) {
  const auto timed = run.monitor().scope("write");
  std::vector<io::NamedLabels> named;
  for (std::size_t k = 0; k < result.labels.size(); ++k)
    named.push_back({source.scene.objects[k].name, result.labels[k]});
  io::LabelledWrite write;
  write.edited = &result.cloud;
  write.source_row = result.source_row;
  std::vector<float> floater;
  for (std::size_t row = 0; !source.floater.empty() && row < std::size_t(result.cloud.size()); ++row)
    floater.push_back(source.floater[result.source_row.empty() ? row : std::size_t(result.source_row[row])]);
  write.floater = floater;
  io::write_labelled_ply(path, source.ply, named, write);
  for (const auto& [name, value] : result.figures) run.result()[name] = value;
  run.result()["converged"] = result.converged;
}

namespace {

/// The steps of Eq. 20. Returns the exit code of a signal, else 0.
int run_steps(cli::Run& run, const RunOptions& options, const Checkpoint& checkpoint, Watch& watch,
              JointTrainer& trainer) {
  cli::Checkpoints checkpoints(run.monitor());
  run.info("step " + std::to_string(trainer.steps_done() + 1) + " begins");
  bool ended = watch.target_met();
  while (!trainer.finished() && !ended) {
    const JointProgress progress = trainer.step();
    run.monitor().progress(progress.step, progress.steps);
    ended = watch.after_step(progress, trainer, [&] { return trainer.result(); });
    const bool periodic = options.checkpoint_every > 0 && progress.step % options.checkpoint_every == 0;
    if (run.monitor().stop_requested()) {
      if (checkpoint.given()) checkpoint.save(trainer);  // all that is left of the run
      return run.stop_code();
    }
    if (checkpoint.given() && periodic) checkpoints.on_the_way([&] { checkpoint.save(trainer); });
  }
  return 0;
}

/// Under a budget the iterations may have ended too early to earn their place: whether the outcome agrees
/// significantly less with the views' own masks than what it started from, as the stage asks of its walk.
bool has_lost(const Solution& outcome, const std::vector<Agreement>& before,
              const std::vector<Agreement>& after) {
  const auto given = outcome.figures.find("contour_contrast_given"),
             refined = outcome.figures.find("contour_contrast_refined");
  if (given == outcome.figures.end() || given->second < kOffEdges * refined->second)
    return false;  // no judges: those masks do not lie on edges
  std::vector<double> gains;
  for (std::size_t i = 0; i < before.size(); ++i) gains.push_back(after[i].biou - before[i].biou);
  return gain_in_errors(gains) < -kSignificant;
}

/// Follows the photos' edges in the iterations that the budget has room for.
Solution run_contours(cli::Run& run, const Settings& settings, const JointJob& problem, Watch& watch,
                       Solution result) {
  Budget& budget = problem.budget;
  const std::size_t views = problem.input.views.size();
  const int epochs = contour_epochs(settings.edge, settings.joint.quality, views);
  if (epochs == 0) return result;  // --effect contours=on at a draft
  std::vector<Agreement> before;
  if (budget.given()) {
    const auto lap = budget.lap(kCheckCost, views);
    before = training_agreement(run.exec(), problem.input, result);
  }
  const auto iterations_that_fit = [&](std::optional<double> first_refine_s) {
    return budget.plan_iterations(settings.joint, settings.edge, problem.input.scene, views, first_refine_s).contour_iterations;
  };
  if (iterations_that_fit({}) == 0) {
    budget.note_cut();
    return result;
  }
  const double early_share = early_iteration_share(parse_effects(settings.joint.effect), epochs);
  double refine_began_s = 0;
  const auto allow = [&](int wanted) {
    const int planned = std::min(wanted, iterations_that_fit(wall_seconds() - refine_began_s));
    const bool no_trial = planned == 1 && may_try_pictures(settings.edge, problem.input.scene);
    const bool last_is_another = early_share < 1;  // then it has to be known which it is; else they end when time is up
    const int iterations = planned == 0 || no_trial || last_is_another ? planned : wanted;
    if (iterations < wanted) budget.note_cut();  // that later iterations or steps were left out the watch knows
    watch.iterations_known(iterations, early_share);
    return iterations;
  };
  const double check_s = budget.foreseen_s(kCheckCost.renders * double(views));
  watch.begin_iterations(check_s);
  run.info("edges begin");
  Solution start = budget.given() ? result : Solution{};
  refine_began_s = wall_seconds();
  result = refine_contours(run.exec(), run.monitor(),
                        {settings.edge, settings.joint, settings.sample, settings.rbf, problem.input,
                         [&](const JointProgress& progress, JointTrainer& trainer, const auto& whole) {
                           return watch.after_step(progress, trainer, whole);
                         },
                         allow},
                        std::move(result));
  if (!budget.given() || result.source_row.empty()) return result;
  const auto lap = budget.lap(kCheckCost, views);
  if (!has_lost(result, before, training_agreement(run.exec(), problem.input, result))) return result;
  run.info("the edges are left out again: too few steps, or the masks disagree");
  start.figures["contour_iterations_undone"] = result.figures["contour_iterations"];
  return start;
}

/// All steps of Eq. 20 where no iteration of edges does a part of their work.
std::int64_t steps_without_contours(const JointOptions& joint, std::size_t views) {
  JointEffects effects = parse_effects(joint.effect);
  effects.edges = false;
  return steps_of(joint, effects, views);
}

/// Steps until `keep_s` of the budget are left. Returns the exit code of a signal, else 0.
int take_steps(cli::Run& run, const Settings& settings, const JointJob& problem, const Checkpoint& checkpoint, bool field,
               double keep_s, Watch& watch, JointTrainer& trainer) {
  watch.begin_steps(keep_s, trainer);
  const double began_s = wall_seconds();
  const std::int64_t done = trainer.steps_done();
  const int stopped = run_steps(run, settings.run, checkpoint, watch, trainer);
  problem.budget.took_steps(trainer.steps_done() - done, field, wall_seconds() - began_s);
  return stopped;
}

}  // namespace

int optimise(cli::Run& run, Decisions& decisions, const JointJob& problem, const Artifacts& artifacts) {
  const Settings settings = decisions.settled();
  Budget& budget = problem.budget;
  JointTrainer trainer(run.device_exec(), run.monitor(),
                       {settings.joint, settings.sample, settings.rbf, problem.input, problem.field},
                       run.allow_empty());
  Watch watch(run.exec(), settings.run, problem.input, budget, !artifacts.trace.empty());
  watch.begin(trainer);
  if (decisions.on("joint")) {
    const TimePlan plan =
        budget.plan(settings.joint, settings.edge, problem.input.scene, problem.input.views.size());
    if (settings.run.resume && problem.checkpoint.load(trainer))
      run.info("resumed after step " + std::to_string(trainer.steps_done()));
    const double keep_s = budget.left_s() - plan.steps_s;
    if (const int stopped = take_steps(run, settings, problem, problem.checkpoint, decisions.on("nerf"), keep_s, watch, trainer))
      return stopped;
  }
  Solution result = trainer.result();
  result.converged = true;
  if (decisions.on("contours") && !watch.target_met()) {
    // The edges keep no state of their own: what is interrupted from here on begins with them.
    if (decisions.on("joint") && problem.checkpoint.given())
      cli::Checkpoints(run.monitor()).on_the_way([&] { problem.checkpoint.save(trainer); });
    result = run_contours(run, settings, problem, watch, std::move(result));
    if (run.monitor().stop_requested()) return run.stop_code();
    const std::int64_t all_steps = steps_without_contours(settings.joint, problem.input.views.size());
    const bool too_few = decisions.on("joint") && trainer.steps_done() < all_steps && result.source_row.empty();
    if (too_few && !watch.target_met() && budget.steps_fit(decisions.on("nerf"))) {
      trainer.plan_steps(all_steps);
      const Checkpoint none("", "");  // that of before the edges stays: they would be followed anew
      if (const int stopped = take_steps(run, settings, problem, none, decisions.on("nerf"), 0, watch, trainer)) return stopped;
      Solution longer = trainer.result();
      longer.figures.merge(result.figures);
      result = std::move(longer);
    }
  }
  result.converged = watch.target_met() || (!watch.cut() && !budget.cut());
  if (budget.given()) run.result()["budget"] = budget.json();
  if (budget.given() && !result.converged)
    run.monitor().warn("--time-budget " + settings.run.time_budget +
                       ": parts were left out or cut short for want of time; result.budget of the report has the times");
  if (!settings.run.target.empty() && !watch.target_met())
    run.monitor().warn("--target " + settings.run.target + ": not reached in the training views");
  const LossTerms& l = watch.last_loss();
  run.result()["last_loss"] = {{"total", l.total}, {"photometric", l.photometric},
                               {"align", l.align}, {"mask", l.mask},
                               {"cont", l.cont},   {"smooth", l.smooth}};
  write_result(run, problem.source, result, artifacts.labelled);
  if (!artifacts.nerf.empty()) write_nerf(artifacts.nerf, trainer);
  if (!artifacts.trace.empty()) io::write_file(artifacts.trace, watch.trace());
  return result.converged ? cli::kDone : cli::kBudgetHit;
}

}  // namespace ngs::joint
