#pragma once
// Takes the label from what only shows through the object.                                       PAPER.md §5.17
#include "ngs/passes/pass.h"

namespace ngs {

class SeenThroughPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  std::vector<EffectVerdict> rules(const TrainingOptions&) const override;
  /// Of its detector; whether there is time for the rest is seen when that is known.
  std::optional<PassCost> cost() const override { return PassCost{1, 0.6}; }
  /// All of its work: the steps of others begin with its labels.
  void begin(PassRun& run) override;
  void run(PassRun&) override {}
};

}  // namespace ngs
