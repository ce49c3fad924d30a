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
  const ObjectWindows& windows(const Exec& exec, const Problem& problem) const;
  mutable std::shared_ptr<const ObjectWindows> windows_;
};

}  // namespace ngs
