#include "ngs/passes/pipeline.h"

#include <algorithm>
#include <span>

namespace ngs {
namespace {

/// Detectors of the optimising passes look at views; those of the mending ones at views that are loaded anyway, and
/// take no more than their passes may.
constexpr PassCost kDetectorsCost{{.renders = 0.25, .halvings = 25}, 0.8};

constexpr const char* kNoTime = "--time-budget has no time for it";
constexpr const char* kBrokenOff = "broken_off";  // of the state that a resumed run repeats

bool was_broken_off(const Json& before, std::string_view name) {
  const Json names = before.value(kBrokenOff, Json::array());
  return std::ranges::any_of(names, [&](const Json& n) { return n.is_string() && n.get<std::string>() == name; });
}

/// Nothing of a pass is left.
void break_off(PassRun& run, std::string_view name) {
  run.budget.note_cut();
  run.decisions.break_off(name, "--time-budget: broken off, it would have taken too long");
  run.state[kBrokenOff].push_back(std::string(name));
  run.report["effects"] = run.decisions.json();
}

/// An effect that would be on is off for want of time. A run that goes on plans its contours anew.
void note_left_out(PassRun& run, std::string_view effect) {
  run.budget.note_cut();
  if (!belongs_to(run.decisions.effects(), effect, "contours")) run.left_out.emplace(effect);
}

}  // namespace

void leave_out_for_time(PassRun& run, std::string_view effect) {
  if (run.decisions.ruled(effect)) return;
  if (run.decisions.may_be_on(effect, *run.problem)) note_left_out(run, effect);
  run.decisions.rule({effect, false, kNoTime});
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
  for (auto pass = passes_.rbegin(); pass != passes_.rend(); ++pass) (*pass)->foresee(run);
}

void Pipeline::leave_out(PassStage stage, PassRun& run) const {
  for (const auto& pass : passes_)
    if (pass->stage() == stage) leave_out_for_time(run, pass->effects().front().name);
}

/// Passes of which a part is worth nothing have to fit; those that take steps share what is left.
void Pipeline::rule_by_time(PassStage stage, PassRun& run) const {
  if (!run.budget.given()) return;
  for (const auto& pass : passes_)
    if (pass->stage() == stage && pass->cost() && !run.budget.fits(*pass->cost(), run.problem->scene.views.size()))
      leave_out_for_time(run, pass->effects().front().name);
  if (stage != PassStage::kOptimise) return;
  const TimePlan plan = run.budget.plan();
  const bool looks = run.budget.fits(kDetectorsCost, run.problem->views.size());
  const auto leave_out = [&](std::string_view effect) {
    if (!looks) return leave_out_for_time(run, effect);
    run.decisions.rule({.name = effect, .on = false, .reason = kNoTime, .asks_first = true});
  };
  if (!plan.steps || !looks) leave_out_for_time(run, "joint");
  if (!plan.field) leave_out("nerf");
  if (plan.contour_iterations == 0 && run.budget.contours.epochs > 0) leave_out("contours");
}

/// The detectors of a stage at work.
struct Pipeline::Detection {
  const Problem& seen;
  double until_s;
  std::optional<SceneProbe> probe = {};
  bool asked = false, broken_off = false;
};

/// Asks the detectors of a pass. Where they take too long, it and its parts are left out; what the probe then knows is
/// of part of the views, and forgotten.
void Pipeline::decide_pass(const Pass& pass, PassRun& run, Detection& by) const {
  std::vector<Effect> effects = pass.effects();
  if (!by.probe) by.probe.emplace(run.exec, run.training, by.seen);
  {
    const bool mends = pass.stage() == PassStage::kMend && pass.cost();
    const Monitor::Limit limit(run.monitor, mends ? run.budget.end_of_s(pass.cost()->share) : by.until_s);
    by.asked |= run.decisions.decide(effects, *by.probe);
    if (!limit.reached()) return;
  }
  by.broken_off = true;
  by.probe.emplace(run.exec, run.training, by.seen);
  std::erase_if(effects, [&](const Effect& effect) { return run.decisions.decided(effect.name); });
  for (const Effect& effect : effects) leave_out_for_time(run, effect.name);
  run.decisions.decide(effects, *by.probe);
}

void Pipeline::decide(PassStage stage, PassRun& run, const Problem& seen) const {
  foresee(run);
  rule_by_time(stage, run);
  const auto timed = run.monitor.scope("detectors");
  const double began_s = wall_seconds();
  const std::size_t known = run.decisions.all().size();
  Detection detection{seen, run.budget.end_of_s(kDetectorsCost.share)};
  for (const auto& pass : passes_)
    if (pass->stage() == stage && !run.monitor.stop_requested()) decide_pass(*pass, run, detection);
  for (const EffectDecision& d : std::span(run.decisions.all()).subspan(known)) {
    if (d.measured) run.say(decision_line(d));
    if (d.overruled) note_left_out(run, d.effect->name);
  }
  // What was broken off tells nothing of the pace of the rest.
  if (detection.asked && !detection.broken_off && stage == PassStage::kOptimise)
    run.budget.took("detectors", double(seen.views.size()) * kDetectorsCost.per_view, wall_seconds() - began_s);
  run.report["effects"] = run.decisions.json();
}

/// Runs a pass, or breaks it off where it takes more than its share: then nothing of it is left. What kept steps begin
/// with must be the same where they are resumed: there the clock has no say.
void Pipeline::run_in_time(Pass& pass, PassRun& run) const {
  const std::string_view name = pass.effects().front().name;
  const bool insisted = run.decisions.mode(name) != EffectMode::kAuto;
  if (run.resumed && was_broken_off(*run.resumed, name)) return break_off(run, name);
  if (run.resumed || insisted || run.store != nullptr || !pass.cost()) return pass.run(run);
  const Pace before = run.budget.pace();
  const Monitor::Limit limit(run.monitor, run.budget.end_of_s(pass.cost()->share));
  pass.run(run);
  if (!limit.reached()) return;
  run.budget.restore(before);
  break_off(run, name);
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
  return each([&](Pass& pass) {
           pass.begin(run);
           if (run.on(pass.effects().front().name)) run_in_time(pass, run);
         }) &&
         each([&](Pass& pass) { pass.finish(run); });
}

}  // namespace ngs
