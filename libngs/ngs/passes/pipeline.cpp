#include "ngs/passes/pipeline.h"

#include <algorithm>
#include <ranges>

namespace ngs {
namespace {

/// Detectors of the optimising passes look at views; those of the mending ones at views that are loaded anyway.
constexpr PassCost kDetectorsCost{1.5, 0.6};

}  // namespace

void leave_out_for_time(PassRun& run, std::string_view effect) {
  const bool insisted = run.decisions.mode(effect) != EffectMode::kAuto;
  if (!insisted && run.decisions.may_be_on(effect, *run.problem)) run.budget.note_cut();
  run.decisions.rule({effect, false, "--time-budget has no time for it"});
}

std::vector<Effect> Pipeline::effects() const {
  std::vector<Effect> all;
  for (const auto& pass : passes_)
    for (Effect& effect : pass->effects()) all.push_back(std::move(effect));
  return all;
}

std::vector<Effect> Pipeline::effects(PassStage stage) const {
  std::vector<Effect> all;
  for (const auto& pass : passes_)
    if (pass->stage() == stage)
      for (Effect& effect : pass->effects()) all.push_back(std::move(effect));
  return all;
}

void Pipeline::declare(OptionSet& options, const OptionGroup& group) const {
  for (const auto& pass : passes_) pass->declare(options, group);
}

std::vector<EffectVerdict> Pipeline::rules(const TrainingOptions& training) const {
  std::vector<EffectVerdict> all;
  for (const auto& pass : passes_)
    for (EffectVerdict& verdict : pass->rules(training)) all.push_back(std::move(verdict));
  return all;
}

void Pipeline::foresee(PassRun& run) const {
  for (const auto& pass : passes_ | std::views::reverse) pass->foresee(run);
}

void Pipeline::leave_out(PassStage stage, PassRun& run) const {
  for (const auto& pass : passes_)
    if (pass->stage() == stage) leave_out_for_time(run, pass->effects().front().name);
}

/// Passes that cannot be stopped midway have to fit; those that take steps share what is left.
void Pipeline::rule_by_time(PassStage stage, PassRun& run) const {
  if (!run.budget.given()) return;
  for (const auto& pass : passes_)
    if (pass->stage() == stage && pass->cost() && !run.budget.fits(*pass->cost(), run.problem->scene.views.size()))
      leave_out_for_time(run, pass->effects().front().name);
  if (stage != PassStage::kOptimise) return;
  const TimePlan plan = run.budget.plan();
  if (!plan.steps || !run.budget.fits(kDetectorsCost, run.problem->views.size())) leave_out_for_time(run, "joint");
  if (!plan.field) leave_out_for_time(run, "nerf");
  if (plan.contour_iterations == 0 && run.budget.contours.epochs > 0) leave_out_for_time(run, "contours");
}

void Pipeline::decide(PassStage stage, PassRun& run, const Problem& seen) const {
  foresee(run);
  rule_by_time(stage, run);
  const auto timed = run.monitor.scope("detectors");
  const double began_s = wall_seconds();
  SceneProbe probe(run.exec, run.training, seen);
  const std::size_t known = run.decisions.all().size();
  const bool asked = run.decisions.decide(effects(stage), probe);
  for (const EffectDecision& d : run.decisions.all() | std::views::drop(known))
    if (d.measured) run.say(decision_line(d));
  if (asked && stage == PassStage::kOptimise)
    run.budget.took("detectors", kDetectorsCost.renders * double(seen.views.size()), wall_seconds() - began_s);
  run.report["effects"] = run.decisions.json();
}

bool Pipeline::run(PassStage stage, PassRun& run) const {
  foresee(run);
  const auto each = [&](const auto& what) {
    for (const auto& pass : passes_) {
      if (pass->stage() != stage) continue;
      if (run.monitor.stop_requested()) return false;
      what(*pass);
    }
    return !run.monitor.stop_requested();
  };
  return each([&](Pass& pass) { pass.begin(run); }) && each([&](Pass& pass) {
           if (run.on(pass.effects().front().name)) pass.run(run);
         }) &&
         each([&](Pass& pass) { pass.finish(run); });
}

}  // namespace ngs
