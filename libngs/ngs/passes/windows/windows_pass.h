#pragma once
// Windows: every other pass works on the parts of the views that show the objects.                 PAPER.md §5.16
#include "ngs/passes/pass.h"
#include "ngs/problem/window_input.h"

namespace ngs {

class WindowsPass final : public Pass {
 public:
  PassStage stage() const override { return PassStage::kFocus; }
  std::vector<Effect> effects() const override;
  void run(PassRun& run) override;

 private:
  /// Share of the pixels beside the windows; where masks alone leave too little for windows to be worth it, what they
  /// leave, and nothing is drawn.
  double outside(const Exec& exec, const Problem& problem) const;
  const ObjectWindows& windows(const Exec& exec, const Problem& problem) const;

  mutable ObjectWindows of_masks_;  // until windows_ are there
  mutable std::shared_ptr<const ObjectWindows> windows_;
};

}  // namespace ngs
