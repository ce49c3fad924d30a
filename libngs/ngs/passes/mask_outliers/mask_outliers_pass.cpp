#include "ngs/passes/mask_outliers/mask_outliers_pass.h"

#include <algorithm>

#include "ngs/ops/image/mask_pair.h"
#include "ngs/passes/detectors.h"
#include "ngs/passes/mask_outliers/mask_outliers.h"
#include "ngs/problem/view_list.h"
#include "ngs/stages/boundary/method_labels.h"
#include "ngs/stages/render/render_stage.h"

namespace ngs {
namespace {

/// Disagreement of one view's masks with the objects rendered alone, summed over objects: what hides them may be
/// floaters.
double disagreement_alone(const Exec& exec, const Problem& problem, const Camera& camera, const ViewMasks& masks) {
  RenderedView view;
  view.label = ImageF(camera.width_px, camera.height_px, int(problem.labels.size()));
  show_objects_alone(exec, {problem.cloud, problem.labels}, camera, problem.splat, view);
  double sum = 0;
  for (std::size_t k = 0; k < masks.target.size(); ++k)
    sum += disagreement(MaskPair(view.label, masks, k).counts(exec));
  return sum;
}

double worst_outlier(SceneProbe& probe) {
  const Problem& problem = probe.problem();
  std::vector<double> better;  // of the model as it stands and the objects alone
  const LabelViews& views = probe.label_views();
  if (probe.stopped()) return 0;
  std::size_t next = 0;  // of `views`
  for_each_view(problem.monitor, problem.views, [&](std::size_t, std::size_t v) {
    const ViewMasks masks = problem.load_masks(v);
    if (!masks.available) return;
    const std::size_t at = next++;
    if (!views.shown[at]) return;  // as judge_views() leaves it out
    const double alone = disagreement_alone(probe.exec(), problem, problem.scene.views[v].camera, masks);
    better.push_back(std::min(views.disagreement[at], alone) / double(masks.target.size()));
  });
  return outlier_score(better);
}

}  // namespace

std::vector<Effect> MaskOutliersPass::effects() const {
  return {{.name = "mask-outliers",
           .help = "ignore masks that the others contradict",
           .saves = "the consensus of the others, view by view",
           .detector = {"worst view's disagreement, in halves of what would ignore it", 1,
                        "half the distance at which a view is ignored", worst_outlier},
           .was = "view-trust"}};
}

void MaskOutliersPass::run(PassRun& run) {
  const auto outliers = std::make_shared<const MaskOutliers>(judge_views(run.exec, run.monitor, {}, *run.coarse));
  if (run.monitor.stop_requested()) return;
  Json names = Json::array();
  for (const std::size_t v : outliers->ignored) {
    const std::string& name = run.problem->scene.views[v].camera.name;
    names.push_back(name);
    run.monitor.warn("the mask of view '" + name +
                     "' contradicts the masks of the other views and is ignored; --effect mask-outliers=off keeps it");
  }
  Json& report = run.report["mask_outliers"] = {{"ignored", names}};
  for (const auto& [name, value] : outliers->figures) report[name] = value;
  if (outliers->ignored.empty()) return;
  Problem& problem = *run.problem;
  problem.load_masks = [load = problem.load_masks, outliers](std::size_t view) {
    return consistent_masks(*outliers, view, load(view));
  };
  problem.labels = problem.whole ? labels_without_views(run.exec, run.monitor, problem, outliers->ignored)
                                 : labels_anew(run.exec, run.monitor, problem, problem.cloud);
}

}  // namespace ngs
