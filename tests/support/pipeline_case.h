#pragma once
// Runs the passes of ngs-joint on a problem in memory.
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/pipeline.h"

namespace ngs::test {

/// A store that discards all steps.
class NullStepStore final : public StepStore {
 public:
  bool load(JointTrainer&) override { return false; }
  void save(JointTrainer&) override {}
  void try_save(JointTrainer&) override {}
  void steps_running(bool) override {}
  std::int64_t save_interval() const override { return 0; }
};

/// One run; `problem` and the stores must outlive it. `passes`: empty: all.
class PipelineCase {
 public:
  PipelineCase(const Problem& problem, const TrainingOptions& training, const std::vector<std::string>& entries,
               std::vector<std::unique_ptr<Pass>> passes = {}, const Exec& exec = {})
      : exec_(exec),
        pipeline_(passes.empty() ? all_passes(training.losses) : std::move(passes)),
        training_(training),
        switches_(pipeline_.effects(), entries),
        decisions_(pipeline_.effects(), switches_, pipeline_.fixed_decisions(training)),
        run_{.exec = exec_,
             .monitor = monitor_,
             .training = training,
             .decisions = decisions_,
             .budget = budget_,
             .report = report_,
             .optimisation = {.allow_empty = true}} {
    coarse_.emplace(problem).monitor = &monitor_;
    run_.problem.emplace(*coarse_);
    run_.coarse = &*coarse_;
  }
  PipelineCase(const PipelineCase&) = delete;
  PipelineCase& operator=(const PipelineCase&) = delete;

  /// Sets an option of a pass, before decisions are made.
  void set(const std::string& option, const std::string& value) {
    OptionSet options;
    pipeline_.declare(options, {});
    options.set_text(option, {value});
  }
  /// Stops a run when the flag is set, as a signal does.
  void stop_flag(const std::atomic<bool>& flag) { monitor_.stop_flag(&flag); }
  /// Resumes another run from its state (ResumeState::state) and, if given, its stored decisions.
  void resume_from(const Json& state) { run_.resume.before = state; }
  void resume_from(const Json& state, const Json& effects, const Json& skipped) {
    resume_from(state);
    repeat_decisions(pipeline_, run_, effects, skipped);
  }
  /// Stores steps, so that another run can resume.
  void store_steps(StepStore& store) { run_.optimisation.store = &store; }
  void trace() { run_.optimisation.tracking.traced = true; }
  /// Starts the time budget now.
  void time_budget(double seconds) { budget_ = Budget(wall_seconds(), seconds); }
  /// Makes the decisions of both stages, without running passes.
  const Decisions& decide() {
    pipeline_.decide(PassStage::kRepair, run_, *run_.problem);
    pipeline_.decide(PassStage::kOptimise, run_, *run_.problem);
    return decisions_;
  }
  /// Makes the decisions of the first stage and runs it.
  void repair() {
    pipeline_.decide(PassStage::kRepair, run_, *run_.problem);
    pipeline_.run(PassStage::kRepair, run_);
  }
  PassRun& run() {
    for (const PassStage stage : {PassStage::kRepair, PassStage::kOptimise}) {
      pipeline_.decide(stage, run_, *run_.problem);
      pipeline_.run(stage, run_);
    }
    return run_;
  }
  Json kept() const { return stored_decisions(pipeline_, decisions_); }
  const Problem& problem() const { return *run_.problem; }
  const Solution& solution() const { return *run_.solution; }
  const Json& report() const { return report_; }
  Decisions& decisions() { return decisions_; }

 private:
  const Exec exec_;
  Monitor monitor_;
  Pipeline pipeline_;
  TrainingOptions training_;
  EffectSwitches switches_;
  Decisions decisions_;
  Budget budget_{0, std::nullopt};
  Json report_ = Json::object();
  std::optional<Problem> coarse_;
  PassRun run_;
};

}  // namespace ngs::test
