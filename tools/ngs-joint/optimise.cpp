#include "optimise.h"

#include "ngs/io/atomic_file.h"

namespace ngs::joint {
namespace {

/// The lines of --trace. Time spent on scoring is kept out of `t` and stated apart.
class Trace {
 public:
  void add(const JointProgress& progress, const std::string& view, double seconds, const Agreement* agreement,
           double scoring_s) {
    const LossTerms& l = progress.loss;
    Json line{{"t", seconds},
              {"step", progress.step},
              {"view", view},
              {"loss",
               {{"total", l.total},
                {"photometric", l.photometric},
                {"align", l.align},
                {"mask", l.mask},
                {"cont", l.cont},
                {"smooth", l.smooth}}}};
    if (agreement)
      line["training_iou"] = agreement->iou, line["training_biou"] = agreement->biou,
      line["scoring_s"] = scoring_s;
    text_ += line.dump() + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

std::string options_text(Settings& settings) {
  OptionSet set;
  set.add(settings.joint);
  set.add(settings.edge);
  set.add(settings.sample);
  set.add(settings.rbf);
  return set.to_json().dump();
}

std::vector<LabelColumns> labels_of(const io::GaussianPly& ply, const Scene& scene) {
  const std::size_t wanted = scene.objects.size();
  if (wanted == 1 && !ply.labels.label.empty() && !ply.labels.boundary.empty() && !ply.labels.views.empty() &&
      !ply.labels.prob.empty())
    return {ply.labels};
  std::vector<LabelColumns> labels;
  for (const SceneObject& object : scene.objects)
    for (const io::NamedLabels& named : ply.objects)
      if (named.object == object.name) labels.push_back(named.columns);
  if (labels.size() != wanted)
    throw Error(ErrorCode::kBadInput,
                "the model has ngs_ columns for " + std::to_string(labels.size()) + " of the scene's " +
                    std::to_string(wanted) + " objects, expected all of them",
                "label it first: ngs-variance scene.json -o boundary.ply");
  return labels;
}

void write_result(cli::Run& run, const Source& source, const MethodResult& result, const std::string& path) {
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

int optimise(cli::Run& run, Settings& settings, const Problem& problem, const Artifacts& artifacts) {
  const double start = wall_seconds();
  const std::optional<double> budget = parse_budget(settings.run.time_budget);
  const std::optional<Target> target = parse_target(settings.run.target);
  JointTrainer trainer(run.exec(), run.monitor(),
                       {settings.joint, settings.sample, settings.rbf, problem.input, problem.field},
                       run.allow_empty());
  if (settings.run.resume && problem.checkpoint.given() && problem.checkpoint.load(trainer))
    run.info("resumed after step " + std::to_string(trainer.steps_done()));
  const bool scored = target.has_value() || !artifacts.trace.empty();
  const std::int64_t every =
      settings.run.trace_every > 0 ? settings.run.trace_every : std::int64_t(problem.input.views.size());
  Trace trace;
  double scoring_s = 0, step_s = 0;
  bool target_met = false;
  JointProgress progress;
  while (!trainer.finished() && !target_met) {
    // A step is not begun that the budget has no time for, judged by the longest so far; writing takes its
    // share too.
    if (budget && wall_seconds() - start + 1.5 * step_s > *budget) break;
    const double before = wall_seconds();
    progress = trainer.step();
    step_s = std::max(step_s, wall_seconds() - before);
    run.monitor().progress(progress.step, progress.steps);
    Agreement agreement;
    const bool score_now = scored && progress.step % every == 0;
    if (score_now) {
      const double scoring_start = wall_seconds();
      agreement = training_agreement(run.exec(), problem.input, trainer.result());
      scoring_s += wall_seconds() - scoring_start;
      target_met = target && (target->boundary ? agreement.biou : agreement.iou) >= target->value;
    }
    if (!artifacts.trace.empty())
      trace.add(progress, problem.input.scene.views[progress.view].camera.name,
                wall_seconds() - start - scoring_s, score_now ? &agreement : nullptr, scoring_s);
    const bool periodic =
        settings.run.checkpoint_every > 0 && progress.step % settings.run.checkpoint_every == 0;
    if (problem.checkpoint.given() && (periodic || run.monitor().stop_requested()))
      problem.checkpoint.save(trainer);
    if (run.monitor().stop_requested()) return run.stop_code();
  }
  MethodResult result = trainer.result();
  result.converged |= target_met;
  if (result.converged && !target_met && parse_effects(settings.joint.effect).edges) {
    const auto late = [&] { return budget && wall_seconds() - start + 1.5 * step_s > *budget; };
    result = follow_edges(run.exec(), run.monitor(),
                          {settings.edge, settings.joint, settings.sample, settings.rbf, problem.input, late},
                          std::move(result));
    if (run.monitor().stop_requested()) return run.stop_code();
  }
  const LossTerms& l = progress.loss;
  run.result()["last_loss"] = {{"total", l.total}, {"photometric", l.photometric},
                               {"align", l.align}, {"mask", l.mask},
                               {"cont", l.cont},   {"smooth", l.smooth}};
  run.result()["effects"] = explain(settings.joint);
  write_result(run, problem.source, result, artifacts.labelled);
  if (!artifacts.nerf.empty()) write_nerf(artifacts.nerf, trainer);
  if (!artifacts.trace.empty()) io::write_file(artifacts.trace, trace.text());
  return result.converged ? cli::kDone : cli::kBudgetHit;
}

}  // namespace ngs::joint
