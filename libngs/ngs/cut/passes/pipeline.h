#pragma once
// Runs the passes in order: decides which are on, limits their time, and reports.                   paper.md §5.7
#include <memory>
#include <vector>

#include "ngs/cut/passes/pass.h"

namespace ngs {

class Pipeline {
 public:
  explicit Pipeline(std::vector<std::unique_ptr<Pass>> passes) : passes_(std::move(passes)) {}

  std::vector<Effect> effects() const;
  std::vector<Effect> effects(PassStage stage) const;
  std::vector<Effect> decided_again_on_resume() const;
  const std::vector<std::unique_ptr<Pass>>& passes() const { return passes_; }
  void declare(OptionSet& options, const OptionGroup& group) const;
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions& training) const;

  /// Decides the effects of a stage by heuristics measured on `problem`, which may have a reduced size. Without time
  /// left, passes are skipped.
  void decide(PassStage stage, PassRun& run, const Problem& problem) const;
  /// Runs the passes that are on. False: a stop was requested, and `run` holds no result.
  bool run(PassStage stage, PassRun& run) const;

 private:
  struct HeuristicContext;
  void decide_pass(const Pass& pass, PassRun& run, HeuristicContext& context) const;
  void run_in_time(Pass& pass, PassRun& run) const;

  std::vector<std::unique_ptr<Pass>> passes_;
};

/// Switches an effect off for lack of time. Has no effect if --effect or a fixed decision sets it. The budget is marked
/// as cut only if the effect might have been on. `decided_again_on_resume`: of its pass.
void skip_for_time(PassRun& run, std::string_view effect, bool decided_again_on_resume = false);

// A resumed run repeats the decisions of the stopped run, because time-dependent decisions could differ.

/// The decisions that determine the state of the joint steps, as "NAME=on" and "NAME=off"; a resumed run repeats these.
Json stored_decisions(const Pipeline& pipeline, const Decisions& decisions);

/// Adds the stored decisions of the stopped run as fixed decisions. Switches of --effect and earlier fixed decisions
/// take precedence. Entries that are no decision on a known effect are ignored.
///   effects    stored_decisions() of the stopped run
///   skipped   its ResumeState::skipped
void repeat_decisions(const Pipeline& pipeline, PassRun& run, const Json& effects, const Json& skipped);

}  // namespace ngs
