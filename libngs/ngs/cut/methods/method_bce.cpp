#include "ngs/cut/methods/method_bce.h"

#include "ngs/backend/for_each.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/scene/rle_masks.h"

namespace ngs {
namespace {

constexpr double kHalfWeightsGap = 5e-4;
constexpr std::int64_t kCacheBytes = std::int64_t(2048) << 20;  // of weights; further views are composited each time

void note_figures(const LabelSolution& s, const std::string& suffix, std::map<std::string, double>& figures) {
  figures["loss" + suffix] = s.loss;
  figures["gap" + suffix] = s.gap;
  figures["relative_gap" + suffix] = s.loss > 0 ? s.gap / s.loss : 0.0;
  figures["evaluations" + suffix] = s.evaluations;
  figures["rounds" + suffix] = s.rounds;
  figures["columns" + suffix] = double(s.columns);
  figures["working_columns" + suffix] = double(s.working_columns);
  figures["cache_mib" + suffix] = double(s.cache.cached_bytes) / (1 << 20);
  figures["streamed_views" + suffix] = double(s.cache.streamed_views);
}

/// The masks of one object. Every evaluation reads them all, so masks that need less than one byte per pixel as run
/// lengths are cached; the others are decoded each time.
class CachedTargets {
 public:
  CachedTargets(const Problem& input, std::size_t object)
      : input_(input), object_(object), cache_(input.views.size()) {}

  /// Decodes all masks, several at a time.
  void preload(const Exec& exec) {
    for_each_task(exec, std::int64_t(cache_.size()), [this](std::int64_t i) { load(std::size_t(i)); });
  }

  PixelTargets load(std::size_t i) {
    if (cache_[i].available()) return pixel_targets(cache_[i].unpacked(), 0);
    ViewMasks masks = input_.load_masks(input_.views[i]);
    if (!masks.available) return {};
    masks.target = {std::move(masks.target[object_])};
    const std::size_t pixels = masks.target[0].size();
    PixelTargets targets = pixel_targets(masks, 0);
    if (RleMasks packed(std::move(masks)); packed.bytes() < pixels) cache_[i] = std::move(packed);
    return targets;
  }

 private:
  const Problem& input_;
  std::size_t object_;
  std::vector<RleMasks> cache_;  // [views]
};

/// Sets the labels to the soft values: the fitted masks are renders of these, and thresholding would move the contours.
/// With several objects only the one with the largest value gets the Gaussian.
void assign_labels(std::vector<LabelColumns>& labels) {
  for (std::size_t i = 0; i < labels[0].label.size(); ++i) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < labels.size(); ++k)
      if (labels[k].prob[i] > labels[best].prob[i]) best = k;
    for (std::size_t k = 0; k < labels.size(); ++k) {
      LabelColumns& c = labels[k];
      if (c.views[i] > 0) c.label[i] = k == best ? c.prob[i] : 0.f;
    }
  }
}

}  // namespace

BceResult solve_bce(const Exec& exec, Monitor& monitor, const BceOptions& options, const Problem& input) {
  BceResult result;
  result.method.cloud = unchanged(input.cloud);
  std::vector<LabelColumns>& labels = result.method.labels = closed_form_labels(exec, monitor, input);
  const auto timed = monitor.scope("label solve");
  LabelSolveOptions solve;
  solve.relative_gap = options.relative_gap;
  solve.max_evaluations = options.max_evaluations;
  solve.cache_bytes = kCacheBytes;
  solve.stop = [&] { return monitor.stop_requested(); };
  const auto n = std::size_t(input.cloud.size());
  for (std::size_t k = 0; k < labels.size(); ++k) {
    LabelProblem problem{input.cloud, {}, {}, input.splat, false};
    for (const std::size_t view : input.views) problem.cameras.push_back(input.scene.views[view].camera);
    // The working set is solved with rounded weights, the certificate uses exact ones. On real scenes the rounding
    // costs a relative gap of about 1e-5.
    problem.half_weights = options.relative_gap >= kHalfWeightsGap;
    CachedTargets targets(input, k);
    targets.preload(exec);
    problem.load_targets = [&](std::size_t i) { return targets.load(i); };
    std::vector<double> start(n);
    std::vector<std::uint8_t> movable(n);
    for (std::size_t i = 0; i < n; ++i) {
      movable[i] = labels[k].views[i] > 0 && !is_fixed(input, i);
      start[i] = double(movable[i] ? labels[k].prob[i] : labels[k].label[i]);
    }
    LabelSolution solution = solve_labels(exec, problem, solve, start, movable);
    for (std::size_t i = 0; i < n; ++i)
      if (movable[i]) labels[k].prob[i] = float(solution.label[i]);
    note_figures(solution, labels.size() > 1 ? "_" + input.scene.objects[k].name : "", result.method.figures);
    result.method.converged &= solution.converged;
    result.trace.push_back(std::move(solution.trace));
  }
  assign_labels(labels);
  restore_fixed(input, {}, labels);
  for (const LabelColumns& c : labels) result.method.figures["object_gaussians"] += labelled_count(c);
  return result;
}

}  // namespace ngs
