#pragma once
// Crops the views to windows about the objects; all other passes work on the crops.                paper.md §5.16
#include "ngs/passes/pass.h"
#include "ngs/problem/window_input.h"

namespace ngs {

class WindowsPass final : public Pass {
 public:
  PassStage stage() const override { return PassStage::kCrop; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;

 private:
  /// Share of the pixels outside the windows. If the share outside the boxes of the masks is already too small, returns
  /// that share without rendering.
  double outside(const Exec& exec, const Problem& problem) const;
  const ObjectWindows& windows(const Exec& exec, const Problem& problem) const;

  mutable ObjectWindows of_masks_;  // until windows_ are there
  mutable std::shared_ptr<const ObjectWindows> windows_;
};

}  // namespace ngs
