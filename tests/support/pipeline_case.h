#pragma once
// The passes of ngs-joint on a problem in memory.
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ngs/passes/pass_list.h"
#include "ngs/passes/pipeline.h"
#include "ngs/passes/resumed_decisions.h"

namespace ngs::test {

/// Steps are kept, it says, and forgets them.
class KeepsNothing final : public StepStore {
 public:
  bool load(JointTrainer&) override { return false; }
  void save(JointTrainer&) override {}
  void save_on_the_way(JointTrainer&) override {}
  void taking_steps(bool) override {}
  std::int64_t every() const override { return 0; }
};

/// One run; what it refers to must outlive it.
class PipelineCase {
 public:
  PipelineCase(const Problem& problem, const TrainingOptions& training, const std::vector<std::string>& entries,
               std::vector<std::unique_ptr<Pass>> passes = all_passes())
      : pipeline_(std::move(passes)),
        training_(training),
        modes_(pipeline_.effects(), entries),
        decisions_(pipeline_.effects(), modes_, pipeline_.rules(training)),
        run_{.exec = exec_,
             .device_exec = exec_,
             .monitor = monitor_,
             .training = training,
             .decisions = decisions_,
             .budget = budget_,
             .report = report_,
             .allow_empty = true} {
    coarse_.emplace(problem).monitor = &monitor_;
    run_.problem.emplace(*coarse_), run_.coarse = &*coarse_;
  }
  PipelineCase(const PipelineCase&) = delete;
  PipelineCase& operator=(const PipelineCase&) = delete;

  /// A value of an option of some pass, before anything is decided.
  void set(const std::string& option, const std::string& value) {
    OptionSet options;
    pipeline_.declare(options, {});
    options.set_text(option, {value});
  }
  /// Asks a run to stop, as a signal does.
  void stop_flag(const std::atomic<bool>& flag) { monitor_.stop_flag(&flag); }
  /// As if another run with that state (PassRun::state) went on, and with its decisions where they are kept.
  void goes_on_from(const Json& state) { run_.resumed = state; }
  void goes_on_from(const Json& state, const Json& effects, const Json& left_out) {
    goes_on_from(state), repeat_decisions(pipeline_, run_, effects, left_out);
  }
  /// With steps that are kept, so that another run may go on.
  void keeps_steps(StepStore& store) { run_.store = &store; }
  /// As if the run had begun now, with so much time.
  void time_budget(double seconds) { budget_ = Budget(wall_seconds(), seconds); }
  /// Decides both stages on the problem as it is, and runs nothing.
  const Decisions& decide() {
    pipeline_.decide(PassStage::kMend, run_, *run_.problem);
    pipeline_.decide(PassStage::kOptimise, run_, *run_.problem);
    return decisions_;
  }
  /// Decides and runs the first of the two stages.
  void mend() { pipeline_.decide(PassStage::kMend, run_, *run_.problem), pipeline_.run(PassStage::kMend, run_); }
  PassRun& run() {
    for (const PassStage stage : {PassStage::kMend, PassStage::kOptimise})
      pipeline_.decide(stage, run_, *run_.problem), pipeline_.run(stage, run_);
    return run_;
  }
  Json kept() const { return kept_decisions(pipeline_, decisions_); }
  const Problem& problem() const { return *run_.problem; }
  const Solution& solution() const { return *run_.solution; }
  const Json& report() const { return report_; }
  Decisions& decisions() { return decisions_; }

 private:
  const Exec exec_;
  Monitor monitor_;
  Pipeline pipeline_;
  TrainingOptions training_;
  EffectSwitches modes_;
  Decisions decisions_;
  Budget budget_{0, std::nullopt};
  Json report_ = Json::object();
  std::optional<Problem> coarse_;
  PassRun run_;
};

}  // namespace ngs::test
