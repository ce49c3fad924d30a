// Contour refinement as a pass.                                                                  paper.md §5.10
#include <algorithm>

#include "ngs/cut/contours/contour_options.h"
#include "ngs/cut/contours/contour_stage.h"
#include "ngs/cut/contours/refined_masks.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

/// A refinement takes about as long as this many evaluations of the training agreement: in the photos, and in photos of
/// the camera's size.
constexpr double kRefineChecks = 8, kHalfRefineChecks = 2;
/// A refinement and half of the steps at full size take about as long as this many of a draft's iterations.
constexpr double kDraftIterations = 3;

bool trained_view_has_photo(const Problem& problem) { return photo_count(problem.scene, problem.views) > 0; }

double straddling(SceneProbe& probe, ContourViews trained) {
  const Problem& problem = probe.problem();
  const std::size_t views = trained == ContourViews::kAll ? problem.scene.views.size() : problem.views.size();
  const std::vector<Camera> some = probe.sample_cameras();
  return straddling_bound_px(problem.cloud, some, problem.splat) * double(views) / double(some.size());
}

double narrow_share(SceneProbe& probe) {
  const Problem& problem = probe.problem();
  const Scene& scene = problem.whole().scene;
  if (photo_views(scene).size() < scene.views.size()) return 1;  // views without a photo drift further at half the size
  std::vector<NarrowParts> sum(problem.labels.size());
  for_each_view(problem.monitor, probe.sample_views(), [&](std::size_t, std::size_t v) {
    const ViewMasks masks = problem.load_masks(v);
    if (!masks.available) return;
    for (std::size_t k = 0; k < masks.target.size(); ++k) {
      const std::vector<std::uint8_t> plane = object_pixels(masks.target[k]);
      const NarrowParts parts = narrow_parts({plane.data(), masks.width_px, masks.height_px});
      sum[k].narrow_px2 += parts.narrow_px2;
      sum[k].all_px2 += parts.all_px2;
    }
  });
  double most = 0;
  for (const NarrowParts& object : sum)
    if (object.all_px2 > 0) most = std::max(most, object.narrow_px2 / object.all_px2);
  return most;
}

/// With a time budget the iterations may end too early. True: the result agrees significantly less with the views'
/// masks than the start did. The stage applies the same test to its refinement.
bool has_lost_agreement(const Solution& outcome, const std::vector<Agreement>& before,
                        const std::vector<Agreement>& after) {
  const auto given = outcome.figures.find("contour_contrast_given"),
             refined = outcome.figures.find("contour_contrast_refined");
  if (given == outcome.figures.end() || given->second < kOffEdges * refined->second)
    return false;  // the masks' contours do not lie on edges
  std::vector<double> gains;
  for (std::size_t i = 0; i < before.size(); ++i) gains.push_back(after[i].biou - before[i].biou);
  return normal_score(gain_in_standard_errors(gains), gains.size()) < -kSignificant;
}

class ContoursPass : public Pass {
 public:
  ContoursPass() : Pass({.stage = PassStage::kOptimise, .follows_clock = true, .decided_again_on_resume = true}) {}
  std::vector<Effect> effects() const override {
    const ContourViews trained = options_.views;
    return {{.name = kContoursEffect,
             .help = "move contours to the photos' edges",
             .saves = "refinement, halving, training on the windows",
             .heuristic = {"views that have a photo; 0: the photos add no edge and the masks reject refined contours",
                           0, "one is enough; the refinement has its own test",
                           [](SceneProbe& probe) {
                             return probe.edge_gain() < -kSignificant ? 0 : probe.views_with_photo();
                           },
                           trained_view_has_photo, "no view has a photo"}},
            {.name = "split",
             .help = "halve Gaussians that straddle contours",
             .saves = "the search for straddling Gaussians, and the added rows",
             .needs = kContoursEffect,
             .heuristic = {"largest weight that a Gaussian can have on the wrong side, px", kSplit_px,
                           "below it no Gaussian would be halved",
                           [trained](SceneProbe& probe) { return straddling(probe, trained); }}},
            {.name = "contour-iterations",
             .help = "refine contours more than once",
             .saves = "all iterations but the first",
             .needs = kContoursEffect,
             .always = "one iteration lost up to 2 points of boundary IoU on scenes with inaccurate masks"},
            {.name = "full-resolution",
             .help = "all iterations at full size, after all steps; off: coarse to fine",
             .saves = "half of the rows, columns and epochs of the other iterations, and the joint steps",
             .needs = "contour-iterations",
             .heuristic = {
                 "largest share of an object in parts narrower than 9 px (1: some view has no photo)", 0.03,
                 "between solid objects (at most 0.02) and small or thin ones (from 0.04), which have few pixels at "
                 "half the size",
                 narrow_share}}};
  }
  void declare(OptionSet& options, const OptionGroup& given) override {
    OptionGroup group = given;
    group.name = group.effect = kContoursEffect;
    group.about = "move contours to the photos' edges";
    options.add(options_, std::move(group));
  }
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions&) const override {
    if (options_.iterations != 1) return {};
    return {{"contour-iterations", false, "--contour-iterations 1"}};
  }
  void run(PassRun& run) override {
    begin_optimisation(run);
    options_.on = {.split = run.on("split"),
                   .iterations = run.on("contour-iterations"),
                   .full_resolution = run.on("full-resolution")};
    Optimisation& at = run.optimisation;
    if (at.tracker->target_met()) return;
    // Contour iterations are not checkpointed: a run that is interrupted in them resumes at their start.
    if (at.store != nullptr && run.on(kJointEffect)) at.store->try_save(*at.trainer);
    at.trainer.reset();  // as large as the model
    Checked checked;
    if (run.budget.is_set()) {
      const Monitor::Limit limit(run.monitor, run.budget.deadline_s(kPassShare));
      checked = check(run);
      if (limit.reached()) return run.budget.mark_partial();
    }
    if (run.monitor.stop_requested()) return;
    // Iterations at half the size gain most per second (decision 096).
    const bool half_only = preset_of(run.training.joint.quality).half_contours;
    const bool half_first = run.budget.is_set() && options_.on.iterations && options_.iterations != 1 &&
                            run.training.joint.quality == Quality::kStandard;
    if (options_.on.full_resolution || !(half_only || half_first)) {
      iterate(run, options_, run.training, false, checked);
      return;
    }
    ContourOptions options = options_;
    // With a budget any iteration may be the last, and one at a quarter of the size gains nothing.
    options.on.full_resolution = run.budget.is_set();
    if (!half_only && options.iterations > 0) --options.iterations;
    TrainingOptions draft = run.training;
    draft.joint.quality = Quality::kDraft;
    const double began_s = wall_seconds();
    const bool refined = iterate(run, options, draft, true, checked);
    if (half_only || !refined || at.tracker->target_met()) return;
    const double iterations = run.solution->figures["contour_iterations"];
    const double iteration_s = (wall_seconds() - began_s) / std::max(1.0, iterations);
    if (!run.budget.allows(kDraftIterations * iteration_s)) return run.budget.mark_partial();
    options.iterations = 1;
    if (iterate(run, options, run.training, false, checked)) run.solution->figures["contour_iterations"] += iterations;
  }

 private:
  /// Agreement of a solution with the training views' masks; with a time budget only.
  struct Checked {
    std::vector<Agreement> views;
    double took_s = 0;
  };
  static Checked check(const PassRun& run) {
    const double began_s = wall_seconds();
    Checked now{training_agreement(run.exec, *run.problem, *run.solution)};
    now.took_s = wall_seconds() - began_s;
    return now;
  }

  /// Refines contours in the time left. False: no time is left, a stop was requested, or the iterations were undone.
  /// `checked`: of the solution, before and after.
  static bool iterate(PassRun& run, const ContourOptions& options, const TrainingOptions& training, bool half_size,
                      Checked& checked) {
    Budget& budget = run.budget;
    Optimisation& at = run.optimisation;
    if (!budget.allows((1 + (half_size ? kHalfRefineChecks : kRefineChecks)) * checked.took_s)) {
      budget.mark_partial();
      return false;
    }
    at.tracker->begin_stage(checked.took_s);
    run.log("contours begin");
    const Solution start = budget.is_set() ? *run.solution : Solution{};
    run.solution = refine_contours(run.exec, run.monitor,
                                   {options, training, *run.problem,
                                    [&](const JointProgress& progress, JointTrainer& trainer, const auto& whole) {
                                      return at.tracker->after_step(progress, trainer, whole);
                                    },
                                    [&](int iterations) { at.tracker->set_iterations(iterations); }, half_size},
                                   std::move(*run.solution));
    if (run.monitor.stop_requested()) return false;
    if (!budget.is_set() || run.solution->source_row.empty()) return true;
    const double undone = run.solution->figures["contour_iterations"];
    const bool too_few = undone <= 1 && at.tracker->too_few_steps();
    if (!too_few) {
      Checked after = check(run);
      if (run.monitor.stop_requested()) return false;
      if (!has_lost_agreement(*run.solution, checked.views, after.views)) {
        checked = std::move(after);
        return true;
      }
    }
    run.log(std::string("contour iterations undone: ") +
            (too_few ? "the time was too short" : "they reduced the agreement with the masks"));
    run.solution = start;
    run.solution->figures["contour_iterations_undone"] = undone;
    return false;
  }

  ContourOptions options_;
};

}  // namespace

std::unique_ptr<Pass> make_contours_pass() { return std::make_unique<ContoursPass>(); }

}  // namespace ngs
