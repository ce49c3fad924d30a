// Crops the views to windows about the objects; all other passes work on the crops.                paper.md §5.16
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/scene_probe.h"
#include "ngs/problem/window_input.h"

namespace ngs {
namespace {

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

constexpr double kMinOutside = 0.5;  // minimum share of pixels outside the windows

}  // namespace

double WindowsPass::outside(const Exec& exec, const Problem& problem) const {
  of_masks_ = windows_of_masks(exec, problem);
  return of_masks_.outside <= kMinOutside ? of_masks_.outside : windows(exec, problem).outside;
}

const ObjectWindows& WindowsPass::windows(const Exec& exec, const Problem& problem) const {
  if (!windows_) windows_ = std::make_shared<const ObjectWindows>(object_windows(exec, problem, std::move(of_masks_)));
  return *windows_;
}

std::vector<Effect> WindowsPass::effects() const {
  return {{.name = "windows",
           .help = "crop the views to windows about the objects",
           .saves = "nothing: whole views are processed",
           .heuristic = {"share of the views' pixels outside the objects' windows", kMinOutside,
                         "below it windows save less than half of the work",
                         [this](SceneProbe& probe) { return outside(probe.exec(), probe.problem()); }}}};
}

void WindowsPass::run(PassRun& run) {
  const auto timed = run.monitor.scope("windows");
  const ObjectWindows& found = windows(run.exec, *run.problem);
  if (run.monitor.stop_requested()) return;
  const auto input = std::make_shared<const WindowInput>(*run.problem, windows_);
  run.report["windows"] = {{"pixels_outside", found.outside},
                           {"empty_views", run.problem->views.size() - input->cropped().views.size()}};
  Problem cropped = input->cropped();
  cropped.uncropped = std::shared_ptr<const Problem>(input, &input->uncropped());
  run.problem.emplace(std::move(cropped));
}

std::unique_ptr<Pass> make_windows_pass() { return std::make_unique<WindowsPass>(); }

}  // namespace ngs
