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
  /// Makes the trainer, whose labels as they come are the solution where the steps are off.
  void begin(PassRun& run) override;
  void run(PassRun& run) override;
  /// Takes the steps that were left to contour iterations where none came.
  void finish(PassRun& run) override;
};

}  // namespace ngs
