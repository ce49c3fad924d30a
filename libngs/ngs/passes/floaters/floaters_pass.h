#pragma once
// Removes floaters in front of the object.                                                      paper.md §5.8
#include "ngs/passes/pass.h"

namespace ngs {

class FloatersPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kRepair; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;
};

}  // namespace ngs
