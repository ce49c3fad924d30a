#pragma once
// Takes the label from what only shows through the object.                                       PAPER.md §5.17
#include "ngs/passes/pass.h"

namespace ngs {

class SeenThroughPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  std::vector<EffectVerdict> rules(const TrainingOptions&) const override;
  std::optional<PassCost> cost() const override { return PassCost{3, 0.5}; }
  /// All of its work: the steps of others begin with its labels.
  void begin(PassRun& run) override;
  void run(PassRun&) override {}
};

}  // namespace ngs
