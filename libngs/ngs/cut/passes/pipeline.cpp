#include "ngs/cut/passes/pipeline.h"

#include <algorithm>
#include <span>

#include "ngs/problem/region.h"

namespace ngs {
namespace {

constexpr const char* kSkippedForTime = "--time-budget: skipped, no time left";
constexpr const char *kAborted = "aborted", *kCoarse = "coarse_contours_follow";  // keys of ResumeState::state

bool was_aborted(const Json& before, std::string_view name) {
  const Json names = before.value(kAborted, Json::array());
  return std::ranges::any_of(names, [&](const Json& n) { return n.is_string() && n.get<std::string>() == name; });
}

void abort_pass(PassRun& run, std::string_view name) {
  run.budget.mark_partial();
  run.decisions.abort(name, "--time-budget: aborted, it would have exceeded its share");
  run.resume.state[kAborted].push_back(std::string(name));
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

/// The problem's model as the solution, still without labels.
Solution unoptimised_solution(const PassRun& run) {
  const Problem& problem = *run.problem;
  const BoundarySet boundary = boundary_to_train(problem, run.on("boundary"), run.optimisation.allow_empty);
  return {.cloud = unchanged(problem.cloud), .figures = {{"steps", 0.0}, {"boundary", double(boundary.size())}}};
}

void set_training(PassRun& run) {
  JointOptions& joint = run.training.joint;
  for (const Decision& decision : run.decisions.all())
    if (!decision.on) joint.off.emplace(decision.effect->name);
  const bool wanted = run.decisions.switch_of(kJointEffect) == Switch::kOn || run.on(kNerfEffect);
  joint.coarse_contours_follow =
      !wanted && joint.on(kContoursEffect) && joint.on("contour-iterations") && !joint.on("full-resolution");
  const Json before = run.resume.before ? run.resume.before->value(kCoarse, Json()) : Json();
  if (before.is_boolean())
    joint.coarse_contours_follow = before.get<bool>();  // other measurements may have had no time
  run.resume.state[kCoarse] = joint.coarse_contours_follow;
}

constexpr const char* kMode = "resumed";

std::string text_of(std::string_view effect, bool on) { return std::string(effect) + (on ? "=on" : "=off"); }

bool holds(const Json& list, const std::string& text) {
  return list.is_array() && std::find(list.begin(), list.end(), Json(text)) != list.end();
}

}  // namespace

void skip_for_time(PassRun& run, std::string_view effect, bool decided_again_on_resume) {
  if (run.decisions.is_fixed(effect)) return;
  if (run.decisions.may_be_on(effect, *run.problem)) {
    run.budget.mark_partial();
    if (!decided_again_on_resume) run.resume.skipped.emplace(effect);
  }
  run.decisions.fix({effect, false, kSkippedForTime});
}

std::vector<Effect> Pipeline::effects() const {
  return effects_of(passes_, [](const Pass&) { return true; });
}

std::vector<Effect> Pipeline::effects(PassStage stage) const {
  return effects_of(passes_, [&](const Pass& pass) { return pass.traits.stage == stage; });
}

std::vector<Effect> Pipeline::decided_again_on_resume() const {
  return effects_of(passes_, [](const Pass& pass) { return pass.traits.decided_again_on_resume; });
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

struct Pipeline::HeuristicContext {
  const Problem& problem;
  std::optional<SceneProbe> probe = {};
};

/// Measures the heuristics of a pass. If the time limit ends a measurement, the pass and its parts are skipped, and the
/// probe is replaced, because its cached values cover only part of the views.
void Pipeline::decide_pass(const Pass& pass, PassRun& run, HeuristicContext& context) const {
  std::vector<Effect> effects = pass.effects();
  for (const Effect& effect : effects)
    if (run.budget.is_set() && effect.skipped_with_budget) skip_for_time(run, effect.name);
  if (!run.budget.allows(0)) skip_for_time(run, effects.front().name, pass.traits.decided_again_on_resume);
  if (!context.probe) context.probe.emplace(run.exec, run.training, context.problem);
  {
    const Monitor::Limit limit(run.monitor, run.budget.deadline_s(kPassShare));
    run.decisions.decide(effects, *context.probe);
    if (!limit.reached()) return;
  }
  context.probe.emplace(run.exec, run.training, context.problem);
  std::erase_if(effects, [&](const Effect& effect) { return run.decisions.decided(effect.name); });
  for (const Effect& effect : effects) skip_for_time(run, effect.name, pass.traits.decided_again_on_resume);
  run.decisions.decide(effects, *context.probe);
}

void Pipeline::decide(PassStage stage, PassRun& run, const Problem& problem) const {
  const auto timed = run.monitor.scope("heuristics");
  const std::size_t decided_before = run.decisions.all().size();
  HeuristicContext context{problem};
  for (const auto& pass : passes_)
    if (pass->traits.stage == stage && !run.monitor.stop_requested()) decide_pass(*pass, run, context);
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
  if (run.resume.before && was_aborted(*run.resume.before, name)) return abort_pass(run, name);
  if (run.resume.before || is_fixed_by_user || run.optimisation.store != nullptr || pass.traits.follows_clock)
    return pass.run(run);
  const Monitor::Limit limit(run.monitor, run.budget.deadline_s(kPassShare));
  pass.run(run);
  if (limit.reached()) abort_pass(run, name);
}

bool Pipeline::run(PassStage stage, PassRun& run) const {
  for (const auto& pass : passes_) {
    if (pass->traits.stage != stage) continue;
    if (run.monitor.stop_requested()) return false;
    if (run.on(pass->effects().front().name)) run_in_time(*pass, run);
  }
  for (auto pass = passes_.rbegin(); pass != passes_.rend() && stage == PassStage::kOptimise; ++pass) {
    if (run.monitor.stop_requested()) return false;
    (*pass)->finish(run);
  }
  return !run.monitor.stop_requested();
}

bool trains(const PassRun& run) { return run.on(kJointEffect) || run.on(kContoursEffect); }

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
  if (!trains(run)) {
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

Json stored_decisions(const Pipeline& pipeline, const Decisions& decisions) {
  const std::vector<Effect> redecided = pipeline.decided_again_on_resume();
  Json kept = Json::array();
  for (const Decision& d : decisions.all())
    if (find_effect(redecided, d.effect->name) == nullptr) kept.push_back(text_of(d.effect->name, d.on || d.aborted));
  return kept;
}

void repeat_decisions(const Pipeline& pipeline, PassRun& run, const Json& effects, const Json& skipped) {
  const std::vector<Effect> redecided = pipeline.decided_again_on_resume();
  for (const Effect& effect : run.decisions.effects()) {
    if (find_effect(redecided, effect.name) != nullptr) continue;
    if (holds(skipped, std::string(effect.name))) {
      skip_for_time(run, effect.name);
    } else {
      for (const bool on : {false, true})
        if (holds(effects, text_of(effect.name, on))) run.decisions.fix({effect.name, on, "--resume", kMode});
    }
  }
}

}  // namespace ngs
