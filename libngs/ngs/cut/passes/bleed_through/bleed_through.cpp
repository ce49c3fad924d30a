#include "ngs/cut/passes/bleed_through/bleed_through.h"

#include <algorithm>
#include <cmath>

#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/passes/pass.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_stage.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

// A label is uncertain below this share. A Gaussian with a larger share is rarely visible outside the object.
constexpr float kCertainShare = 0.8f;

using RowList = std::vector<std::int64_t>;  // increasing

/// The views in which some Gaussians are visible, cropped to those Gaussians.
class ViewsShowing {
 public:
  ViewsShowing(const Exec& exec, const Problem& problem, const RowList& rows)
      : exec_(exec),
        problem_(problem),
        part_(gather_rows(exec, problem.cloud, rows)),
        splat_(prepared_for(exec, problem.splat, part_)) {}

  /// Calls f(camera, masks) for these views until a stop is requested.
  template <class F>
  void for_each(const F& f) const {
    for_each_view(problem_.monitor, problem_.views, [&](std::size_t, std::size_t view) {
      const Camera& camera = problem_.scene.views[view].camera;
      const PixelWindow window = visible_window(camera);
      if (window.w == 0) return;
      ViewMasks masks = problem_.load_masks(view);
      if (!masks.available) return;
      f(window_camera(camera, window), cropped(std::move(masks), window));
    });
  }

 private:
  PixelWindow visible_window(const Camera& camera) const {
    RenderRequest request{.colour = false, .label = {}};
    ImageF alpha = render(exec_, part_, camera, splat_, request).alpha;
    const PixelWindow window = window_of({std::move(alpha.data)}, camera.width_px, camera.height_px, 0);
    return widened(window, 0, camera.width_px, camera.height_px);
  }

  const Exec& exec_;
  const Problem& problem_;
  GaussianCloud part_;
  SplatOptions splat_;
};

/// An uncertain label and its sums over the views, weighted by visibility: Σ α T², Σ α T² M.
struct UncertainLabel {
  std::int64_t row;
  std::size_t object;
  double weight = 0, object_weight = 0;
};

/// [N] 1: the row is in `rows`.
std::vector<std::uint8_t> flags_of(const RowList& rows, std::int64_t n) {
  std::vector<std::uint8_t> flag(std::size_t(n), 0);
  for (const std::int64_t row : rows) flag[std::size_t(row)] = 1;
  return flag;
}

/// Sorted by row.
std::vector<UncertainLabel> uncertain_labels(const Problem& problem, const std::vector<LabelColumns>& labels) {
  std::vector<UncertainLabel> candidates;
  for (std::size_t i = 0; i < std::size_t(problem.cloud.size()); ++i)
    for (std::size_t k = 0; k < labels.size() && !is_fixed(problem, i); ++k)
      if (label_is_foreground(labels[k].label[i]) && labels[k].prob[i] < kCertainShare)
        candidates.push_back({std::int64_t(i), k});
  return candidates;
}

/// Adds the sums of one view. `rows`: the rows of the uncertain labels, in the numbering of `sums`.
void add_view(const ViewSums& sums, const RowNumbers& rows, std::vector<UncertainLabel>& candidates) {
  std::size_t v = 0;
  for (UncertainLabel& candidate : candidates) {
    const std::uint32_t number = rows.number[std::size_t(candidate.row)];
    while (v < sums.size() && sums.row[v] < number) ++v;
    if (v == sums.size()) return;
    if (sums.row[v] == number) {
      candidate.weight += sums.weight(v);
      candidate.object_weight += sums.object_weight(v, candidate.object);
    }
  }
}

/// Per object, the rows that are labelled as the object and have f_T < 1/2.
std::vector<RowList> rows_bleed_through(const Exec& exec, const Problem& problem,
                                        const std::vector<LabelColumns>& labels) {
  std::vector<UncertainLabel> candidates = uncertain_labels(problem, labels);
  std::vector<RowList> found(labels.size());
  if (candidates.empty()) return found;
  RowList rows;
  for (const UncertainLabel& candidate : candidates) rows.push_back(candidate.row);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  const RowNumbers wanted(rows, problem.cloud.size());
  ViewsShowing(exec, problem, rows).for_each([&](const Camera& camera, const ViewMasks& masks) {
    const MaskedView by_visibility{camera, masks, PixelWeight::kByVisibility};
    add_view(view_sums(exec, problem.cloud, by_visibility, problem.splat, &wanted), wanted, candidates);
  });
  for (const UncertainLabel& candidate : candidates)
    if (2 * candidate.object_weight < candidate.weight) found[candidate.object].push_back(candidate.row);
  return found;
}

/// Gain of the second channel over the first in one view: the difference of their squared errors against the mask,
/// divided by the L2 distance of the channels. Counting changed pixels instead would let a mask that is wrong by one
/// pixel count for its neighbours too.
double view_gain(const ImageF& drawn, const ViewMasks& masks, std::size_t object) {
  double gain = 0, change = 0;
  for (std::size_t p = 0; p < masks.target[object].size(); ++p) {
    if (!masks.known.empty() && !masks.known[p]) continue;
    const double mask = masks.target[object][p], now = drawn.data[2 * p], then = drawn.data[2 * p + 1];
    gain += (now - mask) * (now - mask) - (then - mask) * (then - mask);
    change += (then - now) * (then - now);
  }
  return change > 0 ? gain / std::sqrt(change) : 0;
}

/// Gain in agreement with an object's masks if `rows` lose the label, in standard errors of the mean over their views.
double gain_without(const Exec& exec, const Problem& problem, std::size_t object, const LabelColumn& label,
                    const RowList& rows) {
  std::vector<LabelColumns> both(2);
  both[0].label = both[1].label = label;
  for (const std::int64_t row : rows) both[1].label[std::size_t(row)] = 0;
  const LabelChannels channels(exec, problem.cloud, both);
  const std::vector<std::uint8_t> differ = flags_of(rows, problem.cloud.size());  // elsewhere the two are equal
  std::vector<double> gains;
  ViewsShowing(exec, problem, rows).for_each([&](const Camera& camera, const ViewMasks& masks) {
    const double gain = view_gain(channels.view(exec, camera, problem.splat, differ.data()), masks, object);
    if (gain != 0) gains.push_back(gain);
  });
  return gain_in_standard_errors(gains);
}

/// Removes labels of Gaussians that are only visible through the object.                          paper.md §5.17
class BleedThroughPass : public Pass {
 public:
  BleedThroughPass() : Pass({PassStage::kOptimise}) {}
  std::vector<Effect> effects() const override {
    return {{.name = "bleed-through",
             .help = "unlabel Gaussians that are only visible through the object",
             .saves = "evidence weighted by visibility, and its test against the masks",
             .heuristic = {
                 "loss of agreement with the masks by contour refinement, normal score (0: the photos show edges that "
                 "the model does not, or the masks err to one side)",
                 kSignificant, "above it the masks are accurate on average, so labels can be tested against them",
                 [](SceneProbe& probe) { return 0 - probe.edge_gain(); }}}};
  }
  std::vector<FixedDecision> fixed_decisions(const TrainingOptions& training) const override {
    if (preset_of(training.joint.quality).bleed_through) return {};
    return {{"bleed-through", false, "--quality draft"}};
  }
  void run(PassRun& run) override {
    const auto timed = run.monitor.scope("bleed-through");
    Problem& problem = *run.problem;
    BleedThrough finding = without_bleed_through(run.exec, problem, problem.labels);
    if (run.monitor.stop_requested()) return;
    problem.labels = std::move(finding.labels);
    Json objects = Json::array();
    std::int64_t count = 0;
    for (std::size_t k = 0; k < finding.objects.size(); ++k) {
      const BleedThrough::OfObject& of = finding.objects[k];
      objects.push_back({{"object", problem.scene.objects[k].name},
                         {"found", of.found},
                         {"gain", std::isfinite(of.gain) ? Json(of.gain) : Json()},
                         {"taken", of.taken}});
      if (of.taken) count += of.found;
    }
    run.report["bleed_through"] = {{"gaussians", count}, {"objects", std::move(objects)}};
    if (count > 0) run.log(std::to_string(count) + " Gaussians are only visible through the object: label removed");
  }
};

}  // namespace

BleedThrough without_bleed_through(const Exec& exec, const Problem& problem, std::vector<LabelColumns> labels) {
  BleedThrough finding{std::move(labels), {}};
  finding.objects.resize(finding.labels.size());
  const std::vector<RowList> found = rows_bleed_through(exec, problem, finding.labels);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k].empty()) continue;
    LabelColumn& label = finding.labels[k].label;
    const double gain = gain_without(exec, problem, k, label, found[k]);
    if (stop_requested(problem.monitor)) break;
    finding.objects[k] = {std::ssize(found[k]), gain, gain > kSignificant};
    if (!finding.objects[k].taken) continue;
    for (const std::int64_t row : found[k]) label[std::size_t(row)] = 0;
  }
  return finding;
}

std::unique_ptr<Pass> make_bleed_through_pass() { return std::make_unique<BleedThroughPass>(); }

}  // namespace ngs
