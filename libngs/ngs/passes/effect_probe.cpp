#include "ngs/passes/effect_probe.h"

#include <algorithm>
#include <cmath>

#include "ngs/ops/field/knn.h"
#include "ngs/passes/contours/refined_masks.h"
#include "ngs/passes/effect_detectors.h"
#include "ngs/passes/exposure/exposure.h"
#include "ngs/passes/floaters/floaters.h"
#include "ngs/passes/joint/joint_stage.h"
#include "ngs/stages/masks/mask_pair.h"
#include "ngs/stages/render/render_stage.h"
#include "ngs/passes/components/components.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

double disagreement(const Confusion& counts) { return counts.both_empty() ? 0 : 1 - iou(counts); }

}  // namespace

/// What the labels as they come look like in the training views that have masks.
struct EffectProbe::Views {
  std::vector<double> disagreement;  // of the model as it stands, summed over objects; per view
  std::vector<std::uint8_t> shown;   // per view, 1: mask or model shows an object
  double biou = 0;                   // mean over views and objects, modal
  double outside = 0;                // largest over the views
};

EffectProbe::EffectProbe(const Exec& exec, const EffectSetup& setup) : exec_(exec), setup_(setup) {}
EffectProbe::~EffectProbe() = default;

std::vector<Camera> EffectProbe::cameras() const {
  return cameras_of(setup_.input.scene, spread_views(setup_.input.views, kDecisionViews));
}

const EffectProbe::Views& EffectProbe::views() {
  if (views_) return *views_;
  views_ = std::make_unique<Views>();
  const Problem& input = setup_.input;
  const LabelChannels label(input.cloud, input.labels);
  double count = 0;
  for (const std::size_t v : input.views) {
    const ViewMasks masks = input.load_masks(v);
    if (!masks.available) continue;
    const ImageF modal = label.view(exec_, input.scene.views[v].camera, input.splat);
    double stands = 0;
    bool shown = false;
    for (std::size_t k = 0; k < masks.target.size(); ++k) {
      const MaskPair pair(modal, masks, k);
      const Confusion counts = pair.counts(exec_);
      stands += disagreement(counts), shown |= !counts.both_empty();
      views_->biou += pair.biou(exec_);
      ++count;
    }
    views_->disagreement.push_back(stands), views_->shown.push_back(shown);
    const PixelWindow win = window_of(masks.target, masks.width_px, masks.height_px, kRegionMargin_px);
    views_->outside =
        std::max(views_->outside, weight_outside(modal, win.x0, win.y0, win.x0 + win.w, win.y0 + win.h));
  }
  if (count > 0) views_->biou /= count;
  return *views_;
}

const BoundarySet& EffectProbe::boundary() {
  if (!boundary_) {
    std::vector<float> flags(std::size_t(setup_.input.cloud.size()), 0.f);
    for (const LabelColumns& object : setup_.input.labels)
      for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = std::max(flags[i], object.boundary[i]);
    boundary_ = boundary_set(setup_.input.cloud, flags);
  }
  return *boundary_;
}

const KnnGraph& EffectProbe::neighbours() {
  if (!neighbours_) {
    neighbours_.emplace();
    if (boundary().size() > 1)
      neighbours_ = nearest_others(exec_, boundary().positions(), setup_.rbf.neighbours);
  }
  return *neighbours_;
}

double EffectProbe::exposure() {
  const std::vector<std::size_t> some = spread_views(photo_views(setup_.input.scene), kDecisionViews);
  return exposure_spread_percent(view_exposures(exec_, setup_.input, some));
}

double EffectProbe::trust() {
  const Problem& input = setup_.input;
  std::vector<double> better;  // of the model as it stands and the objects alone: what hides them may be floaters
  std::size_t next = 0;        // of views()
  for (const std::size_t v : input.views) {
    const ViewMasks masks = input.load_masks(v);
    if (!masks.available) continue;
    const std::size_t at = next++;
    if (!views().shown[at]) continue;  // as the judge leaves it out (passes/mask_outliers/mask_outliers.h)
    const Camera& camera = input.scene.views[v].camera;
    RenderedView view;
    view.label = ImageF(camera.width_px, camera.height_px, int(input.labels.size()));
    show_objects_alone(exec_, input.cloud, input.labels, camera, input.splat, view);
    double alone = 0;
    for (std::size_t k = 0; k < masks.target.size(); ++k)
      alone += disagreement(MaskPair(view.label, masks, k).counts(exec_));
    better.push_back(std::min(views().disagreement[at], alone) / double(masks.target.size()));
  }
  return outlier_score(better);
}
double EffectProbe::components() { return double(find_disconnected(exec_, {}, setup_.input).count); }
double EffectProbe::front() { return front_opacity(exec_, {}, setup_.input); }
double EffectProbe::gap_without_photos() {
  return photos() > 0 || boundary().size() == 0 ? 0 : 1 - views().biou;
}
double EffectProbe::outside() { return views().outside; }

double EffectProbe::rms_neighbour() {
  return neighbour_rms_levels(neighbours(), {boundary().colour.data(), boundary().size()});
}
double EffectProbe::most_neighbour() {
  return neighbour_most_levels(neighbours(), {boundary().colour.data(), boundary().size()});
}
double EffectProbe::colour_range() {
  return colour_range_levels({boundary().colour.data(), boundary().size()});
}

double EffectProbe::cells() {
  const Problem& in = setup_.input;
  if (boundary().size() < 2) return 0;
  const double reach = field_reach(setup_.sample, in.cloud, cameras_of(in.scene, in.views), boundary());
  const double width = rbf_width(exec_, setup_.rbf, boundary().positions());
  return encoding_cells(exec_, reach, width, boundary().positions(), setup_.joint.hash_finest);
}

double EffectProbe::patches() {
  double most = 0;
  for (const std::size_t v : spread_views(setup_.input.views, kDecisionViews)) {
    const ViewMasks masks = setup_.input.load_masks(v);
    const ImageF photo = setup_.input.load_photo(v);
    if (!masks.available || photo.empty()) continue;
    for (const std::vector<float>& target : masks.target) {
      const std::vector<std::uint8_t> plane = object_pixels(target);
      most = std::max(most, contour_deviation_levels(photo, {plane.data(), masks.width_px, masks.height_px}));
    }
  }
  return most;
}

double EffectProbe::photos() { return double(photo_count(setup_.input.scene, setup_.input.views)); }

double EffectProbe::view_dependence() { return view_dependence_levels(setup_.input.cloud, cameras()); }
double EffectProbe::compensation() {
  return antialias_levels(setup_.input.cloud, cameras(), setup_.input.splat);
}
double EffectProbe::straddling() {
  const std::size_t views =
      setup_.edge.views == ContourViews::kAll ? setup_.input.scene.views.size() : setup_.input.views.size();
  const std::vector<Camera> some = cameras();
  return straddling_bound_px(setup_.input.cloud, some, setup_.input.splat.blur_px2) * double(views) /
         double(some.size());
}

double EffectProbe::narrow() {
  const Scene& scene = setup_.input.scene;
  if (photo_views(scene).size() < scene.views.size()) return 1;  // what no photo holds drifts further at half the size
  std::vector<NarrowParts> sum(setup_.input.labels.size());
  for (const std::size_t v : spread_views(setup_.input.views, kDecisionViews)) {
    const ViewMasks masks = setup_.input.load_masks(v);
    if (!masks.available) continue;
    for (std::size_t k = 0; k < masks.target.size(); ++k) {
      const std::vector<std::uint8_t> plane = object_pixels(masks.target[k]);
      const NarrowParts parts = narrow_parts({plane.data(), masks.width_px, masks.height_px});
      sum[k].narrow_px2 += parts.narrow_px2, sum[k].all_px2 += parts.all_px2;
    }
  }
  double most = 0;
  for (const NarrowParts& object : sum)
    if (object.all_px2 > 0) most = std::max(most, object.narrow_px2 / object.all_px2);
  return most;
}

namespace {

EffectDecision measured_decision(EffectProbe& probe, const EffectInfo& e) {
  const double measured = (probe.*e.measure)();
  const bool on = e.on == OnWhere::kAbove ? measured > e.threshold : measured <= e.threshold;
  return {&e, "auto", on, decision_reason(e, measured, on), measured};
}

}  // namespace

std::optional<EffectDecision> settled_decision(const EffectInfo& e, const std::vector<std::string>& entries,
                                               const std::vector<EffectVerdict>& verdicts,
                                               const std::vector<EffectDecision>& earlier) {
  for (const EffectDecision& d : earlier)
    if (d.effect->name == e.needs && !d.on)
      return EffectDecision{&e, "auto", false, "needs " + std::string(e.needs), {}};
  if (const EffectMode mode = mode_of(e.name, entries); mode != EffectMode::kAuto) {
    const bool on = mode == EffectMode::kOn;
    return EffectDecision{&e, on ? "on" : "off", on, "--effect", {}};
  }
  for (const EffectVerdict& v : verdicts)
    if (v.name == e.name) return EffectDecision{&e, v.mode, v.on, v.reason, {}};
  if (e.on == OnWhere::kAlways) return EffectDecision{&e, "auto", true, "always: " + std::string(e.why), {}};
  return std::nullopt;
}

std::vector<EffectDecision> decide_effects(const Exec& exec, Monitor& monitor, const EffectSetup& setup,
                                           EffectPhase phase, const std::vector<EffectVerdict>& verdicts,
                                           const std::vector<EffectDecision>& before) {
  const auto timed = monitor.scope("detectors");
  EffectProbe probe(exec, setup);
  std::vector<EffectDecision> all = before;
  for (const EffectInfo& e : effect_registry()) {
    if (e.phase != phase) continue;
    const std::optional<EffectDecision> settled = settled_decision(e, setup.joint.effect, verdicts, all);
    all.push_back(settled ? *settled : measured_decision(probe, e));
  }
  return {all.begin() + std::ptrdiff_t(before.size()), all.end()};
}

std::vector<std::string> decided_entries(const std::vector<EffectDecision>& decisions) {
  std::vector<std::string> entries;
  for (const EffectDecision& d : decisions)
    entries.push_back(std::string(d.effect->name) + (d.on ? "=on" : "=off"));
  return entries;
}

}  // namespace ngs
