#pragma once
// Equalises the exposure and white balance of the photos.                                       paper.md §5.14
#include "ngs/passes/pass.h"

namespace ngs {

class ExposurePass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kRepair; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;
};

}  // namespace ngs
