#include "ngs/cut/passes/pipeline.h"

#include <algorithm>
#include <span>

namespace ngs {
namespace {

constexpr const char* kSkippedForTime = "--time-budget: skipped, no time left";
constexpr const char* kAborted = "aborted";  // key of PassRun::state

bool was_aborted(const Json& before, std::string_view name) {
  const Json names = before.value(kAborted, Json::array());
  return std::ranges::any_of(names, [&](const Json& n) { return n.is_string() && n.get<std::string>() == name; });
}

/// Records that a pass was aborted.
void abort_pass(PassRun& run, std::string_view name) {
  run.budget.mark_partial();
  run.decisions.abort(name, "--time-budget: aborted, it would have exceeded its share");
  run.state[kAborted].push_back(std::string(name));
  run.report["effects"] = run.decisions.json();
}

template <class Wanted>
std::vector<Effect> effects_of(const std::vector<std::unique_ptr<Pass>>& passes, const Wanted& wanted) {
  std::vector<Effect> all;
  for (const auto& pass : passes)
    if (wanted(*pass))
      for (Effect& effect : pass->effects()) all.push_back(std::move(effect));
  return all;
}

}  // namespace

void skip_for_time(PassRun& run, std::string_view effect, bool decided_again_on_resume) {
  if (run.decisions.is_fixed(effect)) return;
  if (run.decisions.may_be_on(effect, *run.problem)) {
    run.budget.mark_partial();
    if (!decided_again_on_resume) run.skipped.emplace(effect);
  }
  run.decisions.fix({effect, false, kSkippedForTime});
}

std::vector<Effect> Pipeline::effects() const {
  return effects_of(passes_, [](const Pass&) { return true; });
}

std::vector<Effect> Pipeline::effects(PassStage stage) const {
  return effects_of(passes_, [&](const Pass& pass) { return pass.stage() == stage; });
}

std::vector<Effect> Pipeline::decided_again_on_resume() const {
  return effects_of(passes_, [](const Pass& pass) { return pass.decided_again_on_resume(); });
}

void Pipeline::declare(OptionSet& options, const OptionGroup& group) const {
  for (const auto& pass : passes_) pass->declare(options, group);
}

std::vector<FixedDecision> Pipeline::fixed_decisions(const TrainingOptions& training) const {
  std::vector<FixedDecision> all;
  for (const auto& pass : passes_)
    for (FixedDecision& decision : pass->fixed_decisions(training)) all.push_back(std::move(decision));
  return all;
}

void Pipeline::prepare(PassRun& run) const {
  for (auto pass = passes_.rbegin(); pass != passes_.rend(); ++pass) (*pass)->prepare(run);
}

/// Context in which the heuristics of one stage are measured.
struct Pipeline::HeuristicContext {
  const Problem& problem;
  double deadline_s;
  std::optional<SceneProbe> probe = {};
};

/// Measures the heuristics of a pass. If the time limit ends a measurement, the pass and its parts are skipped, and the
/// probe is replaced, because its cached values cover only part of the views.
void Pipeline::decide_pass(const Pass& pass, PassRun& run, HeuristicContext& context) const {
  std::vector<Effect> effects = pass.effects();
  if (!run.budget.allows(0)) skip_for_time(run, effects.front().name, pass.decided_again_on_resume());
  if (!context.probe) context.probe.emplace(run.exec, run.training, context.problem);
  {
    const Monitor::Limit limit(run.monitor, context.deadline_s);
    run.decisions.decide(effects, *context.probe);
    if (!limit.reached()) return;
  }
  context.probe.emplace(run.exec, run.training, context.problem);
  std::erase_if(effects, [&](const Effect& effect) { return run.decisions.decided(effect.name); });
  for (const Effect& effect : effects) skip_for_time(run, effect.name, pass.decided_again_on_resume());
  run.decisions.decide(effects, *context.probe);
}

void Pipeline::decide(PassStage stage, PassRun& run, const Problem& problem) const {
  prepare(run);
  const auto timed = run.monitor.scope("heuristics");
  const std::size_t decided_before = run.decisions.all().size();
  HeuristicContext context{problem, run.budget.deadline_s(kPassShare)};
  for (const auto& pass : passes_)
    if (pass->stage() == stage && !run.monitor.stop_requested()) decide_pass(*pass, run, context);
  for (const Decision& d : std::span(run.decisions.all()).subspan(decided_before))
    if (d.measured) run.log(decision_line(d));
  run.report["effects"] = run.decisions.json();
}

/// Runs a pass. If the pass exceeds its share of the time, it is aborted, leaves the problem unchanged, and the report
/// records it. Checkpointed steps must start from the same state when they are resumed, so with a checkpoint no pass is
/// aborted.
void Pipeline::run_in_time(Pass& pass, PassRun& run) const {
  const std::string_view name = pass.effects().front().name;
  const bool is_fixed_by_user = run.decisions.switch_of(name) != Switch::kAuto;
  if (run.resumed && was_aborted(*run.resumed, name)) return abort_pass(run, name);
  if (run.resumed || is_fixed_by_user || run.store != nullptr || pass.follows_clock()) return pass.run(run);
  const Monitor::Limit limit(run.monitor, run.budget.deadline_s(kPassShare));
  pass.run(run);
  if (limit.reached()) abort_pass(run, name);
}

bool Pipeline::run(PassStage stage, PassRun& run) const {
  prepare(run);
  std::vector<Pass*> of_stage;
  for (const auto& pass : passes_)
    if (pass->stage() == stage) of_stage.push_back(pass.get());
  for (Pass* pass : of_stage) {
    if (run.monitor.stop_requested()) return false;
    pass->begin(run);
    if (run.on(pass->effects().front().name)) run_in_time(*pass, run);
  }
  for (Pass* pass : of_stage) {
    if (run.monitor.stop_requested()) return false;
    pass->finish(run);
  }
  if (stage == PassStage::kOptimise)
    for (const auto& pass : passes_) {
      if (run.monitor.stop_requested()) return false;
      pass->edit_solution(run);
    }
  return !run.monitor.stop_requested();
}

}  // namespace ngs
