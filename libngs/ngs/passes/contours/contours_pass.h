#pragma once
// Contour refinement as a pass.                                                                  PAPER.md §5.10
#include "ngs/passes/contours/contour_options.h"
#include "ngs/passes/pass.h"

namespace ngs {

class ContoursPass : public Pass {
 public:
  PassStage stage() const override { return PassStage::kOptimise; }
  std::vector<Effect> effects() const override;
  void declare(OptionSet& options, const OptionGroup& group) override;
  std::vector<EffectVerdict> rules(const TrainingOptions& training) const override;
  void foresee(PassRun& run) override;
  void run(PassRun& run) override;

 private:
  /// How many of `wanted` iterations there is time for, after the first refinement took `first_refine_s`.
  int allowed_iterations(PassRun& run, int wanted, double first_refine_s) const;

  ContourOptions options_;
};

}  // namespace ngs
