#pragma once
// A pass of --method ngs: one thing that is done to a problem or to its solution, on its own terms. A pass says what it
// is called, when a scene calls for it, what it costs, and does it; the pipeline (pipeline.h) decides, keeps to the
// time, and reports. A new pass is a folder with a class like the others, and a line in pass_list.cpp.
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"
#include "ngs/passes/decisions.h"
#include "ngs/stages/optimise/joint_trainer.h"
#include "ngs/passes/time/watch.h"
#include "ngs/scene/query_field.h"

namespace ngs {

/// Where the joint steps are kept so that a run can go on (--checkpoint).
class StepStore {
 public:
  virtual ~StepStore() = default;
  /// Goes on from what is kept, where --resume asks for it; false: from the start.
  virtual bool load(JointTrainer& trainer) = 0;
  /// What is left of an interrupted run; fails where it cannot be written.
  virtual void save(JointTrainer& trainer) = 0;
  /// The same on the way: where it cannot be written, the run goes on with a warning.
  virtual void save_on_the_way(JointTrainer& trainer) = 0;
  /// While steps are taken: what would be lost is to be saved once a signal comes.
  virtual void taking_steps(bool begins) = 0;
  /// Steps between saves on the way; 0: none.
  virtual std::int64_t every() const = 0;
};

/// What a run knows, from the first pass to the last. Passes read and change it; nothing else is handed on.
struct PassRun {
  const Exec& exec;
  const Exec& device_exec;  // for joint steps
  Monitor& monitor;
  TrainingOptions training;
  Decisions& decisions;
  Budget& budget;
  Json& report;  // "result" of the run's report: a key per pass
  WatchOptions watching = {};
  bool allow_empty = false;                           // an empty boundary is no error
  std::function<void(const std::string&)> info = {};  // a line for people; may be empty

  std::optional<Problem> problem = {};  // as the passes so far left it
  const Problem* coarse = nullptr;      // what was read, at the size of decisions
  const QueryField* field = nullptr;    // query points of the initial model from a file; null: sampled
  StepStore* store = nullptr;           // null: nothing is kept
  std::optional<Json> resumed = {};     // by pass: what the run that is resumed did, where the clock decided it
  Json state = Json::object();          // the same of this run
  std::set<std::string> left_out = {};  // effects, for want of time; without those that a resumed run decides anew

  std::vector<float> floater = {};  // [N] 1: taken out of the model; empty: none
  bool fields_fit = true;           // query points made for the model that was read still belong to it
  std::unique_ptr<JointTrainer> trainer = {};
  std::optional<Watch> watch = {};
  std::optional<Solution> solution = {};

  void say(const std::string& line) const {
    if (info) info(line);
  }
  bool on(std::string_view effect) const { return decisions.on(effect); }
};

/// Passes of a stage are decided together, on what the stages before left: kFocus says what of the views the others
/// work on; kMend mends masks and model; kOptimise makes the solution.
enum class PassStage : std::uint8_t { kFocus, kMend, kOptimise };

class Pass {
 public:
  virtual ~Pass() = default;
  virtual PassStage stage() const = 0;
  /// The pass itself first, then its parts that can be switched.
  virtual std::vector<Effect> effects() const = 0;
  /// Adds its options, as `group` under a name of its own.
  virtual void declare(OptionSet&, const OptionGroup& /*group*/) {}
  /// What its options decide without naming an effect.
  virtual std::vector<FixedDecision> fixed_decisions(const TrainingOptions&) const { return {}; }
  /// Whether it ends by the clock itself. Others may be aborted under a time budget, and then change nothing in the
  /// run.
  virtual bool follows_clock() const { return false; }
  /// Whether a run that is resumed decides it anew, as nothing of it is kept.
  virtual bool decided_again_on_resume() const { return false; }
  /// Sets what follows from decisions in the training options, as far as they are known: before those of a stage, and
  /// after them; from the last pass to the first, so that a pass knows what follows.
  virtual void prepare(PassRun&) {}
  /// Before run(), whether it is on or off.
  virtual void begin(PassRun&) {}
  /// Where it is on.
  virtual void run(PassRun&) = 0;
  /// After all passes of its stage, whether it is on or off.
  virtual void finish(PassRun&) {}
  /// After finish() of all passes of the last stage: edits run.solution, whether the pass is on or off.
  virtual void edit_solution(PassRun&) {}
};

}  // namespace ngs
