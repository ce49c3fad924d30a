// Removes floaters in front of the object.                                                      paper.md §5.8
#include "ngs/cut/passes/floaters/floaters.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/problem/coarse_input.h"

namespace ngs {
namespace {

constexpr int kCoarseShrink = 2;
constexpr int kRefitEpochs = 3, kCoarseRefitEpochs = 1;  // contour refinement trains the same colours further
constexpr std::size_t kCoarseViews = 48;

/// Whether to search in at most kCoarseViews and to refit briefly at half the decision size: in drafts and with a time
/// budget.
/// A resumed run repeats the choice of the stopped run.
bool is_coarse(const PassRun& run) {
  const Json kept = run.resume.before ? run.resume.before->value("floaters", Json()) : Json();
  if (kept.is_object() && kept.value("draft", Json()).is_boolean()) return kept["draft"].get<bool>();
  return preset_of(run.training.joint.quality).half_floaters || run.budget.is_set();
}

void note(const std::map<std::string, double>& figures, Json& report) {
  for (const auto& [name, value] : figures) report[name] = value;
}

/// Removes the floaters and refits the Gaussians that they covered. False: a stop was requested.
bool remove(PassRun& run, const CoarseInput& coarse, const FloaterFinding& finding, int refit_epochs) {
  FloaterRemoval removal = remove_floaters(run.exec, run.monitor, {.epochs = refit_epochs}, coarse.get(), finding);
  std::vector<LabelColumns> labels =
      labels_without_floaters(run.exec, run.monitor, *run.problem, removal.cloud, finding.floater);
  if (run.monitor.stop_requested()) return false;
  note(removal.figures, run.report["floaters"]);
  Problem next =
      run.problem->with_model(std::make_shared<const GaussianCloud>(std::move(removal.cloud)), std::move(labels));
  next.splat = prepared_for_device(run.exec, next.splat, next.cloud);
  run.problem.emplace(std::move(next));
  run.floater.assign(finding.floater.begin(), finding.floater.end());
  run.log(std::to_string(finding.count) + " floaters in front of the object were removed (column ngs_floater)");
  return true;
}

class FloatersPass : public Pass {
 public:
  FloatersPass() : Pass({PassStage::kRepair}) {}
  std::vector<Effect> effects() const override {
    return {{.name = "floaters",
             .help = "remove floaters in front of the object",
             .saves = "search, removal and refit",
             .heuristic = {"mean opacity in front of the object's surface", 1e-3,
                           "the search removes nothing that hides less (FloaterOptions::min_hidden)",
                           [](SceneProbe& probe) { return front_opacity(probe.exec(), {}, probe.problem()); }}}};
  }
  void run(PassRun& run) override {
    FloaterOptions options;
    const bool coarse_search = is_coarse(run);
    if (coarse_search) options.max_views = kCoarseViews;
    const int shrink = decision_shrink(run.problem->scene) * (coarse_search ? kCoarseShrink : 1);
    const CoarseInput coarse(*run.problem, shrink);
    coarse.preload(run.exec);
    const FloaterFinding finding = find_floaters(run.exec, run.monitor, options, coarse.get());
    if (run.monitor.stop_requested()) return;
    const int refit_epochs = coarse_search ? kCoarseRefitEpochs : kRefitEpochs;
    if (finding.count > 0 && !remove(run, coarse, finding, refit_epochs)) return;
    Json& report = run.report["floaters"];
    report["removed"] = finding.count;
    report["reason"] = finding.count > 0 ? "the photos show the object behind the floaters"
                                         : "Gaussians in front of the object hide too little of it";
    report["sees_past"] = options.sees_past;
    report["least_hidden"] = options.min_hidden;
    note(finding.figures, report);
    run.resume.state["floaters"] = {{"draft", coarse_search}};
  }
};

}  // namespace

std::unique_ptr<Pass> make_floaters_pass() { return std::make_unique<FloatersPass>(); }

}  // namespace ngs
