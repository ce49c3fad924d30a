#pragma once
// Ignores masks that contradict the other views' masks.                                         paper.md §5.9
#include <memory>
#include <vector>

#include "ngs/passes/pass.h"

namespace ngs {

class MaskOutliersPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kRepair; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;

 private:
  /// Cached pretest_masks(), shared by the heuristic and the pass.
  std::shared_ptr<std::vector<double>> pretest_ = std::make_shared<std::vector<double>>();
};

}  // namespace ngs
