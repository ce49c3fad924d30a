#pragma once
// Takes what masks claim far from the object for unseen.                                        PAPER.md §5.13
#include "ngs/passes/pass.h"

namespace ngs {

class ComponentsPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kMend; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;
  void edit_solution(PassRun& run) override;
};

}  // namespace ngs
