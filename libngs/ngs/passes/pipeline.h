#pragma once
// Runs passes in order: decides which are called for, keeps to the time, and reports.                PAPER.md §5.7
#include <memory>
#include <vector>

#include "ngs/passes/pass.h"

namespace ngs {

class Pipeline {
 public:
  explicit Pipeline(std::vector<std::unique_ptr<Pass>> passes) : passes_(std::move(passes)) {}

  /// Of all passes, in order.
  std::vector<Effect> effects() const;
  std::vector<Effect> effects(PassStage stage) const;
  /// Of the passes that a resumed run decides anew.
  std::vector<Effect> decided_again_on_resume() const;
  const std::vector<std::unique_ptr<Pass>>& passes() const { return passes_; }
  void declare(OptionSet& options, const OptionGroup& group) const;
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions& training) const;

  /// Decides on `seen`, which may be the problem at a fraction of its size. Where the time is up, passes are left out.
  void decide(PassStage stage, PassRun& run, const Problem& seen) const;
  /// Runs the passes that are on. False: a signal asked to stop, and nothing in `run` is a result.
  bool run(PassStage stage, PassRun& run) const;

 private:
  struct Detection;
  void decide_pass(const Pass& pass, PassRun& run, Detection& by) const;
  void run_in_time(Pass& pass, PassRun& run) const;
  void prepare(PassRun& run) const;

  std::vector<std::unique_ptr<Pass>> passes_;
};

/// Leaves an effect out for want of time. Nothing is cut short where it was off anyway, or where --effect or a verdict
/// insists. `decided_again_on_resume`: as of its pass.
void leave_out_for_time(PassRun& run, std::string_view effect, bool decided_again_on_resume = false);

}  // namespace ngs
