#pragma once
// Contour refinement as a pass.                                                                  paper.md §5.10
#include "ngs/passes/pass.h"
#include "ngs/stages/contours/contour_options.h"

namespace ngs {

class ContoursPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  void declare(OptionSet& options, const OptionGroup& group) override;
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions& training) const override;
  bool follows_clock() const override { return true; }
  bool decided_again_on_resume() const override { return true; }
  void prepare(PassRun& run) override;
  void run(PassRun& run) override;

 private:
  ContourOptions options_;
};

}  // namespace ngs
