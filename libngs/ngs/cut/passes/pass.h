#pragma once
// Interface of the passes of --method ngs. A pass makes one change to the problem or to its solution. It declares its
// effects (effect.h), its options and its heuristic. The pipeline (pipeline.h) decides which passes run, limits their
// time, and reports. To add a pass, write a class in a new folder and add a line each to pass_list.h and .cpp.
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ngs/cut/passes/decisions.h"
#include "ngs/cut/passes/time/step_tracker.h"
#include "ngs/cut/training/joint_trainer.h"
#include "ngs/options/option_set.h"
#include "ngs/scene/query_field.h"

namespace ngs {

/// Checkpoints of the joint steps (--checkpoint).
class StepStore {
 public:
  virtual ~StepStore() = default;
  /// With --resume, restores the trainer from the checkpoint. False: there is none, training starts at step 0.
  virtual bool load(JointTrainer& trainer) = 0;
  /// Writes the final checkpoint of an interrupted run. Throws if it cannot be written.
  virtual void save(JointTrainer& trainer) = 0;
  /// Writes a checkpoint during the run. Warns if it cannot be written.
  virtual void try_save(JointTrainer& trainer) = 0;
  /// Called with true before the first step and with false after the last one. In between, a signal must leave time
  /// for a save.
  virtual void steps_running(bool running) = 0;
  /// Steps between checkpoints; 0: none during the run.
  virtual std::int64_t save_interval() const = 0;
};

/// The optimisation of labels and Gaussians, shared by the passes joint and contours.
struct Optimisation {
  TrackerOptions tracking = {};
  const QueryField* field = nullptr;  // query points of the initial model from a file; null: sampled
  StepStore* store = nullptr;         // null: no checkpoints
  bool allow_empty = false;           // an empty boundary set is no error
  // Set by begin_optimisation().
  std::optional<StepTracker> tracker = {};
  std::unique_ptr<JointTrainer> trainer = {};  // null: neither joint steps nor contours are on
};

struct ResumeState {
  std::optional<Json> before = {};     // `state` of the run that is resumed
  Json state = Json::object();         // by pass: time-dependent choices
  std::set<std::string> skipped = {};  // effects skipped for lack of time, except those that a resumed run redecides
};

/// State of a run, shared by all passes. Passes communicate only through it.
struct PassRun {
  const Exec& exec;
  Monitor& monitor;
  TrainingOptions training;
  Decisions& decisions;
  Budget& budget;
  Json& report;                                       // "result" of the run's report: one key per pass
  std::function<void(const std::string&)> info = {};  // receives log lines; may be empty
  Optimisation optimisation = {};
  ResumeState resume = {};

  std::optional<Problem> problem = {};  // current problem, after the passes so far
  const Problem* coarse = nullptr;      // input problem at the reduced size used for decisions
  std::vector<float> floater = {};      // [N] 1: removed from the model; empty: none
  std::optional<Solution> solution = {};

  void log(const std::string& line) const {
    if (info) info(line);
  }
  bool on(std::string_view effect) const { return decisions.on(effect); }
};

/// True: labels or Gaussians are trained.
bool trains(const PassRun& run);
/// Makes trainer, tracker and the closed-form solution, unless they are there.
void begin_optimisation(PassRun& run);

/// Passes of one stage are decided together, on the output of the stage before.
/// kCrop crops the views; kRepair repairs masks, photos and model; kOptimise computes the solution.
enum class PassStage : std::uint8_t { kCrop, kRepair, kOptimise };

struct PassTraits {
  PassStage stage;
  bool follows_clock = false;            // obeys the time budget itself; other passes may be aborted, which undoes them
  bool decided_again_on_resume = false;  // because the checkpoint does not depend on it
};

class Pass {
 public:
  explicit Pass(const PassTraits& t) : traits(t) {}
  virtual ~Pass() = default;
  const PassTraits traits;

  /// First the effect of the whole pass, then those of its parts.
  virtual std::vector<Effect> effects() const = 0;
  /// Declares the options of the pass: a copy of `group` with the pass's own name.
  virtual void declare(OptionSet&, const OptionGroup& /*group*/) {}
  /// Decisions that follow from option values.
  virtual std::vector<FixedDecision> fixed_decisions(const TrainingOptions&) const { return {}; }
  /// Called if the pass is on.
  virtual void run(PassRun&) = 0;
  /// Called at the end of the last stage, from the last pass to the first, also if the pass is off. Completes the
  /// solution.
  virtual void finish(PassRun&) {}
};

}  // namespace ngs
