#pragma once
// Ignores masks that the other views' masks contradict.                                         PAPER.md §5.9
#include "ngs/passes/pass.h"

namespace ngs {

class MaskOutliersPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kMend; }
  std::vector<Effect> effects() const override;
  std::optional<PassCost> cost() const override { return PassCost{1.5, 0.15}; }
  void run(PassRun& run) override;
};

}  // namespace ngs
