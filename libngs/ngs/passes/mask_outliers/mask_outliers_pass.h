#pragma once
// Ignores masks that contradict the other views' masks.                                         PAPER.md §5.9
#include <memory>
#include <vector>

#include "ngs/passes/pass.h"

namespace ngs {

class MaskOutliersPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kMend; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;

 private:
  /// Cached first_look(), shared by the heuristic and the pass.
  std::shared_ptr<std::vector<double>> first_ = std::make_shared<std::vector<double>>();
};

}  // namespace ngs
