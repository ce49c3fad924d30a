#pragma once
// Treats labelled Gaussians that are disconnected from the object as unseen.                    paper.md §5.13
#include "ngs/passes/pass.h"

namespace ngs {

class ComponentsPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kRepair; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;
  void edit_solution(PassRun& run) override;
};

}  // namespace ngs
