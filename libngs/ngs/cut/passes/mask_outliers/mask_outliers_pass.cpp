// Ignores masks that contradict the other views' masks.                                         paper.md §5.9
#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/passes/mask_outliers/mask_outliers.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_stage.h"

namespace ngs {
namespace {

/// Disagreement of a view's masks with the objects rendered alone, because occluders may be floaters.
class DisagreementAlone {
 public:
  DisagreementAlone(const Exec& exec, const Problem& problem)
      : problem_(problem), objects_(exec, problem.cloud, problem.labels), last_(objects_.size(), 0.0) {}

  /// The sum over the objects. If the sum is at least `enough`, any value of at least `enough` may be returned. Objects
  /// that disagreed most in the previous view come first, so that few objects suffice to reach `enough`.
  double at_most(const Exec& exec, double enough, const Camera& camera, const ViewMasks& masks) {
    if (enough <= 0) return 0;
    std::vector<std::size_t> order(objects_.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t k) { return last_[k]; });
    double so_far = 0;
    for (const std::size_t k : order) {
      const ImageF alone = objects_.view(exec, k, camera, problem_.splat);
      const ViewMasks own{masks.width_px, masks.height_px, {masks.target[k]}, masks.known, true};
      last_[k] = disagreement(MaskPair(alone, own, 0, foreground_boxes(alone)[0]).counts(exec));
      if ((so_far += last_[k]) > kCertain * enough) return std::max(so_far, enough);
    }
    return std::accumulate(last_.begin(), last_.end(), 0.0);
  }

 private:
  static constexpr double kCertain = 1 + 1e-9;  // sums in another order differ by rounding

  const Problem& problem_;
  ObjectsAlone objects_;
  std::vector<double> last_;  // [K]
};

/// Score without a pretest, from all views.
double worst_of_few(SceneProbe& probe) {
  const Problem& problem = probe.problem();
  std::vector<double> better;  // smaller disagreement of the whole model and the objects alone, per view
  const LabelViews& views = probe.label_views();
  if (probe.stopped()) return 0;
  DisagreementAlone alone(probe.exec(), problem);
  std::size_t next = 0;  // of `views`
  for_each_view(problem.monitor, problem.views, [&](std::size_t, std::size_t v) {
    const ViewMasks masks = problem.load_masks(v);
    if (!masks.available) return;
    const std::size_t at = next++;
    if (!views.shown[at]) return;  // find_mask_outliers() excludes it from the median too
    const double modal = views.disagreement[at];
    const double drawn_alone = alone.at_most(probe.exec(), modal, problem.scene.views[v].camera, masks);
    better.push_back(std::min(modal, drawn_alone) / double(masks.target.size()));
  });
  return outlier_score(better);
}

double worst_of_many(const std::vector<double>& pretest) {
  std::vector<double> shown;
  for (const double d : pretest)
    if (d >= 0) shown.push_back(d);
  return outlier_score(shown);
}

/// pretest_masks() of a problem, cached in `pretest`.
const std::vector<double>& cached_pretest(std::vector<double>& pretest, const Exec& exec, const Problem& problem) {
  if (pretest.size() != problem.views.size()) pretest = pretest_masks(exec, problem);
  return pretest;
}

class MaskOutliersPass : public Pass {
 public:
  MaskOutliersPass() : Pass({PassStage::kRepair}) {}
  std::vector<Effect> effects() const override {
    return {
        {.name = "mask-outliers",
         .help = "ignore masks that contradict the other views' masks",
         .saves = "a consensus of the other views for each view",
         .heuristic = {"largest disagreement of a view, in halves of the outlier threshold", 1,
                       "half of the threshold above which a view is ignored", [pretest = pretest_](SceneProbe& probe) {
                         const std::vector<double>& many = cached_pretest(*pretest, probe.exec(), probe.problem());
                         return many.empty() ? worst_of_few(probe) : worst_of_many(many);
                       }}}};
  }
  void run(PassRun& run) override {
    const auto outliers = std::make_shared<const MaskOutliers>(
        find_mask_outliers(run.exec, run.monitor, *run.coarse, cached_pretest(*pretest_, run.exec, *run.coarse)));
    if (run.monitor.stop_requested()) return;
    std::optional<Problem> next;
    if (!outliers->ignored.empty()) {
      next.emplace(*run.problem);
      next->load_masks = [load = next->load_masks, outliers](std::size_t view) {
        return consistent_masks(*outliers, view, load(view));
      };
      next->labels = next->uncropped ? labels_without_views(run.exec, run.monitor, *next, outliers->ignored)
                                     : recompute_labels(run.exec, run.monitor, *next, next->cloud);
      if (run.monitor.stop_requested()) return;
    }
    Json names = Json::array();
    for (const std::size_t v : outliers->ignored) {
      const std::string& name = run.problem->scene.views[v].camera.name;
      names.push_back(name);
      run.monitor.warn(
          "the mask of view '" + name +
          "' contradicts the masks of the other views and is ignored; --effect mask-outliers=off keeps it");
    }
    Json& report = run.report["mask_outliers"] = {{"ignored", names}};
    for (const auto& [name, value] : outliers->figures) report[name] = value;
    if (next) run.problem.emplace(std::move(*next));
  }

 private:
  /// Cached pretest_masks(), shared by the heuristic and the pass.
  std::shared_ptr<std::vector<double>> pretest_ = std::make_shared<std::vector<double>>();
};

}  // namespace

std::unique_ptr<Pass> make_mask_outliers_pass() { return std::make_unique<MaskOutliersPass>(); }

}  // namespace ngs
