#include "prepare.h"

#include <cstdio>

#include "budget.h"
#include "ngs/math/median.h"
#include "ngs/problem/coarse_input.h"
#include "ngs/stages/boundary/method_labels.h"
#include "ngs/stages/scene/scene_check.h"
#include "ngs/passes/components/components.h"
#include "ngs/problem/view_list.h"

namespace ngs::joint {
namespace {

constexpr int kDraftShrink = 2;
constexpr std::size_t kComparedViews = 3;

}  // namespace

int decision_shrink(const Scene& scene) {
  int longest_px = 0;
  for (const SceneView& view : scene.views)
    longest_px = std::max({longest_px, view.camera.width_px, view.camera.height_px});
  return longest_px >= 512 ? 2 : 1;
}

void compare_with_photos(cli::Run& run, const Problem& input) {
  const auto timed = run.monitor().scope("compare with photos");
  const std::vector<std::size_t> with_photo = photo_views(input.scene);
  std::vector<double> gains_db;
  for (std::size_t n = 0; n < std::min<std::size_t>(with_photo.size(), kComparedViews); ++n) {
    const std::size_t v = with_photo[n * with_photo.size() / kComparedViews];
    gains_db.push_back(match_photo(run.exec(), input.cloud, input.scene.views[v].camera, input.splat, input.load_photo(v)).gain_db());
  }
  if (gains_db.empty()) return;
  const double gain_db = upper_median(std::move(gains_db)), least_db = SceneCheckOptions{}.min_fit_db;
  if (gain_db >= least_db) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the rendered model matches the photos %.1f dB above a constant colour, expected at least %.1f: is it this scene's?",
                gain_db, least_db);
  run.monitor().warn(text);
}

std::vector<ViewExposure> handle_exposure(cli::Run& run, const Problem& input) {
  const auto timed = run.monitor().scope("exposure");
  std::vector<ViewExposure> exposures = view_exposures(run.exec(), input, photo_views(input.scene));
  Json gains = Json::object();
  for (const ViewExposure& e : exposures) gains[input.scene.views[e.view].camera.name] = e.gain;
  run.result()["exposure"] = {{"gains", gains}};
  return exposures;
}

Problem with_levelled_photos(const Problem& input, const std::vector<ViewExposure>& exposures) {
  Problem levelled = input;
  if (exposures.empty()) return levelled;
  const auto level = [&exposures](std::function<ImageF(std::size_t)> load) {
    return [&exposures, load = std::move(load)](std::size_t view) {
      return levelled_photo(exposures, view, load(view));
    };
  };
  levelled.load_photo = level(input.load_photo);
  if (input.load_fine_photo) levelled.load_fine_photo = level(input.load_fine_photo);
  return levelled;
}

MaskOutliers handle_mask_outliers(cli::Run& run, const Problem& input) {
  MaskOutliers trust = judge_views(run.exec(), run.monitor(), {}, input);
  Json names = Json::array();
  for (const std::size_t v : trust.ignored) {
    names.push_back(input.scene.views[v].camera.name);
    run.monitor().warn(
        "the mask of view '" + input.scene.views[v].camera.name +
        "' contradicts the masks of the other views and is ignored; --effect mask-outliers=off keeps it");
  }
  Json report = {{"ignored", names}};
  for (const auto& [name, value] : trust.figures) report[name] = value;
  run.result()["mask_outliers"] = report;
  return trust;
}

Problem with_consistent_masks(cli::Run& run, const Problem& input, const MaskOutliers& trust) {
  Problem trusted = input;
  if (trust.ignored.empty()) return trusted;
  trusted.load_masks = [load = input.load_masks, &trust](std::size_t view) {
    return consistent_masks(trust, view, load(view));
  };
  trusted.labels = labels_anew(run.exec(), run.monitor(), trusted, input.cloud);
  return trusted;
}

FloaterOutcome handle_floaters(cli::Run& run, const Problem& input, Quality quality, Budget& budget,
                               const std::optional<FloaterPlan>& kept) {
  FloaterOutcome outcome;
  const FloaterOptions options;
  const std::size_t views = input.scene.views.size();
  const bool draft = kept ? kept->draft : quality == Quality::kDraft || !budget.fits(kFloatersCost, views);
  outcome.plan.draft = draft;
  const int shrink = decision_shrink(input.scene) * (draft ? kDraftShrink : 1);
  const CoarseInput coarse(input, shrink);
  coarse.preload(run.exec());
  const FloaterFinding finding = [&] {
    const auto lap = budget.lap(draft ? kDraftSearchCost : kFloaterSearchCost, views);
    return find_floaters(run.exec(), run.monitor(), options, coarse.get());
  }();
  Json report = {{"removed", finding.count},
                 {"reason", finding.count > 0 ? "the photos show the object behind them"
                                              : "what lies before the object hides too little of it"},
                 {"seen_through", options.seen_through},
                 {"least_hidden", options.least_hidden}};
  for (const auto& [name, value] : finding.figures) report[name] = value;
  if (finding.count > 0) {
    const RefitOptions refit{.epochs = kept && kept->refit_epochs > 0 ? kept->refit_epochs : budget.plan_refit(draft, shrink, views)};
    outcome.plan.refit_epochs = refit.epochs;
    FloaterRemoval removal = [&] {
      const auto lap = budget.lap_refit(refit.epochs, shrink, views);
      return remove_floaters(run.exec(), run.monitor(), refit, coarse.get(), finding);
    }();
    for (const auto& [name, value] : removal.figures) report[name] = value;
    outcome.labels =
        labels_without_floaters(run.exec(), run.monitor(), input, removal.cloud, finding.floater);
    outcome.cloud = std::move(removal.cloud);
    outcome.floater.assign(finding.floater.begin(), finding.floater.end());
    run.info(std::to_string(finding.count) +
             " floaters before the object were taken out (column ngs_floater)");
  }
  run.result()["floaters"] = report;
  return outcome;
}

Problem without_floaters(const Problem& input, const FloaterOutcome& outcome) {
  return {.cloud = outcome.removed() ? outcome.cloud : input.cloud,
          .scene = input.scene,
          .views = input.views,
          .load_masks = input.load_masks,
          .load_photo = input.load_photo,
          .splat = input.splat,
          .background = input.background,
          .seed = input.seed,
          .fixed = input.fixed,
          .labels = outcome.removed() ? SharedLabels(outcome.labels) : input.labels,
          .load_fine_photo = input.load_fine_photo,
          .held = input.held};
}

bool release_disconnected(cli::Run& run, Problem& input) {
  ComponentFinding finding = find_disconnected(run.exec(), {}, input);
  run.result()["components"] = {{"found", finding.count}};
  if (finding.count == 0) return false;
  input.held.resize(finding.stray.size());
  for (std::size_t i = 0; i < finding.stray.size(); ++i) input.held[i] |= finding.stray[i];
  input.labels = std::move(finding.labels);
  run.info(std::to_string(finding.count) + " Gaussians that masks claim lie apart from the object: taken for unseen");
  return true;
}

}  // namespace ngs::joint
