#pragma once
// Removes labels of Gaussians that are only visible through the object.                          paper.md §5.17
#include "ngs/passes/pass.h"

namespace ngs {

class BleedThroughPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions&) const override;
  void run(PassRun& run) override;
};

}  // namespace ngs
