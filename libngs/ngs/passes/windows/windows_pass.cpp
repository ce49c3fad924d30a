#include "ngs/passes/windows/windows_pass.h"

#include "ngs/passes/scene_probe.h"

namespace ngs {

const ObjectWindows& WindowsPass::windows(const Exec& exec, const Problem& problem) const {
  if (!windows_) windows_ = std::make_shared<const ObjectWindows>(object_windows(exec, problem));
  return *windows_;
}

std::vector<Effect> WindowsPass::effects() const {
  return {{.name = "windows",
           .help = "work on the parts of the views that show the objects",
           .saves = "nothing: whole views are worked on",
           .detector = {"share of the views' pixels beside the objects' windows", 0.5,
                        "below it windows save less than half of the work",
                        [this](SceneProbe& probe) { return windows(probe.exec(), probe.problem()).outside; }}}};
}

void WindowsPass::run(PassRun& run) {
  const auto timed = run.monitor.scope("windows");
  const ObjectWindows& found = windows(run.exec, *run.problem);
  if (run.monitor.stop_requested()) return;
  const auto input = std::make_shared<const WindowInput>(*run.problem, windows_);
  run.report["windows"] = {{"pixels_outside", found.outside},
                           {"empty_views", run.problem->views.size() - input->get().views.size()}};
  Problem focused = input->get();
  focused.whole = std::shared_ptr<const Problem>(input, &input->whole());
  run.problem.emplace(std::move(focused));
}

}  // namespace ngs
