#pragma once
// The joint NeRF-GS optimisation (Eq. 20) as a pass.
#include "ngs/passes/pass.h"

namespace ngs {

class JointPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions&) const override;
  bool follows_clock() const override { return true; }
  void prepare(PassRun& run) override;
  /// Creates the trainer. If the steps are off, its closed-form labels are the solution.
  void begin(PassRun& run) override;
  void run(PassRun& run) override;
  /// Runs the steps that were left to contour iterations, if no iteration ran.
  void finish(PassRun& run) override;
};

}  // namespace ngs
