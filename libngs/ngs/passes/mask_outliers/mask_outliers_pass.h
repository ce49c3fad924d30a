#pragma once
// Ignores masks that the other views' masks contradict.                                         PAPER.md §5.9
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
  /// first_look() at the problem: the detector's is the pass's.
  std::shared_ptr<std::vector<double>> first_ = std::make_shared<std::vector<double>>();
};

}  // namespace ngs
