// Crops the views to windows about the objects; all other passes work on the crops.                paper.md §5.16
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/training/scene_probe.h"
#include "ngs/problem/window_input.h"

namespace ngs {
namespace {

constexpr double kMinOutside = 0.5;  // minimum share of pixels outside the windows

/// The windows of a problem, computed once, for the heuristic and the pass.
class ProblemWindows {
 public:
  /// Share of the pixels outside the windows. If the share outside the boxes of the masks is already too small, returns
  /// that share without rendering.
  double outside(const Exec& exec, const Problem& problem) {
    of_masks_ = windows_of_masks(exec, problem);
    return of_masks_.outside <= kMinOutside ? of_masks_.outside : get(exec, problem)->outside;
  }
  const std::shared_ptr<const ObjectWindows>& get(const Exec& exec, const Problem& problem) {
    if (!windows_)
      windows_ = std::make_shared<const ObjectWindows>(object_windows(exec, problem, std::move(of_masks_)));
    return windows_;
  }

 private:
  ObjectWindows of_masks_;  // until windows_ are there
  std::shared_ptr<const ObjectWindows> windows_;
};

class WindowsPass final : public Pass {
 public:
  WindowsPass() : Pass({PassStage::kCrop}) {}
  std::vector<Effect> effects() const override {
    return {{.name = "windows",
             .help = "crop the views to windows about the objects",
             .saves = "nothing: whole views are processed",
             .heuristic = {"share of the views' pixels outside the objects' windows", kMinOutside,
                           "below it windows save less than half of the work", [windows = windows_](SceneProbe& probe) {
                             return windows->outside(probe.exec(), probe.problem());
                           }}}};
  }
  void run(PassRun& run) override {
    const auto timed = run.monitor.scope("windows");
    const std::shared_ptr<const ObjectWindows> found = windows_->get(run.exec, *run.problem);
    if (run.monitor.stop_requested()) return;
    const auto input = std::make_shared<const WindowInput>(*run.problem, found);
    run.report["windows"] = {{"pixels_outside", found->outside},
                             {"empty_views", run.problem->views.size() - input->cropped().views.size()}};
    Problem cropped = input->cropped();
    cropped.uncropped = std::shared_ptr<const Problem>(input, &input->uncropped());
    run.problem.emplace(std::move(cropped));
  }

 private:
  const std::shared_ptr<ProblemWindows> windows_ = std::make_shared<ProblemWindows>();
};

}  // namespace

std::unique_ptr<Pass> make_windows_pass() { return std::make_unique<WindowsPass>(); }

}  // namespace ngs
