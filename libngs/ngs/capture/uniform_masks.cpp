#include "ngs/capture/uniform_masks.h"

#include <algorithm>

#include "ngs/core/listed.h"
#include "ngs/math/median.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "ngs/render/render_stage.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

constexpr std::size_t kMaxLabelling = 16, kMaxCompared = 8;  // views
constexpr double kMinOfUsual = 0.25, kMinOfFull = 0.5;
constexpr double kMinMaskAgreement = 0.5;  // IoU

struct UniformMaskInputs {
  const GaussianCloud& cloud;
  const Scene& scene;
  std::vector<std::size_t> plain, others;  // indices of scene.views, each with a mask; plain: empty or full
  MaskLoader load_masks;
};

/// Pixel counts of a view, over pixels with a known mask.
struct PixelCounts {
  double known = 0, mask = 0, shown = 0, both = 0;
  double share_of(double pixels) const { return known > 0 ? pixels / known : 0; }
};

/// One label for all objects. Gaussians visible in no mask's view have the label of the nearest seen one.
LabelColumns label_of_any(const Exec& exec, const GaussianCloud& cloud, const std::vector<LabelColumns>& objects) {
  std::vector<float> label(std::size_t(cloud.size()), 0.f);
  std::vector<std::uint32_t> seen, unseen;
  for (std::size_t i = 0; i < label.size(); ++i) {
    for (const LabelColumns& object : objects) label[i] = std::max(label[i], float(object.label[i]));
    if (cloud.usable[i]) (objects[0].views[i] > 0 ? seen : unseen).push_back(std::uint32_t(i));
  }
  LabelColumns any;
  any.label = label;
  if (seen.empty() || unseen.empty()) return any;
  const std::vector<float> points = gather_column(exec, cloud.position, 3, seen),
                           queries = gather_column(exec, cloud.position, 3, unseen);
  const KnnGraph nearest = nearest_points(exec, {points.data(), std::int64_t(seen.size())},
                                          {queries.data(), std::int64_t(unseen.size())}, 1);
  for (std::size_t q = 0; q < unseen.size(); ++q) any.label[unseen[q]] = any.label[seen[nearest.index[q]]];
  return any;
}

PixelCounts count_pixels(const ImageF& shown, const ViewMasks& masks) {
  PixelCounts counts;
  for (std::size_t p = 0; p < shown.data.size(); ++p) {
    if (!masks.known.empty() && masks.known[p] == 0) continue;
    const bool in_mask =
        std::ranges::any_of(masks.target, [&](const auto& target) { return mask_is_foreground(target[p]); });
    const bool is_shown = label_is_foreground(shown.data[p]);
    counts.known += 1;
    counts.mask += in_mask;
    counts.shown += is_shown;
    counts.both += in_mask && is_shown;
  }
  return counts;
}

/// The first of these views by name, and how many more there are.
std::string some_names(const Scene& scene, const std::vector<std::size_t>& views) {
  std::vector<std::string> names;
  for (const std::size_t view : views) names.push_back(scene.views[view].camera.name);
  return listed(names, 4);
}

UniformMasks check_uniform_masks(const Exec& exec, Monitor& monitor, const UniformMaskInputs& in) {
  UniformMasks result{in.plain, {}, 1};
  if (in.plain.empty() || in.others.empty()) return result;
  const auto timed = monitor.scope("empty masks");
  const std::vector<std::size_t> labelling = spread_views(in.others, kMaxLabelling);
  const SplatOptions splat = prepared_for(exec, splat_options({}, in.cloud, in.scene), in.cloud);
  const Evidence evidence = accumulate_evidence(exec, monitor, {in.cloud, in.scene, labelling, splat, in.load_masks});
  const LabelChannels labels(exec, in.cloud, {label_of_any(exec, in.cloud, label_gaussians({}, evidence))});
  const auto count = [&](std::size_t view) {
    return count_pixels(labels.masks(exec, in.scene.views[view].camera, splat), in.load_masks(view));
  };
  double both = 0, either = 0;
  std::vector<double> usual;
  for (const std::size_t view : spread_views(labelling, kMaxCompared)) {
    const PixelCounts counts = count(view);
    both += counts.both;
    either += counts.mask + counts.shown - counts.both;
    usual.push_back(counts.share_of(counts.mask));
  }
  result.agreement = either > 0 ? both / either : 0;
  if (result.agreement < kMinMaskAgreement) return result;
  const double least = kMinOfUsual * upper_median(usual);
  for_each_view(&monitor, in.plain, [&](std::size_t, std::size_t view) {
    const PixelCounts counts = count(view);
    const double shown = counts.share_of(counts.shown);
    if (counts.mask > 0 ? shown < kMinOfFull : shown > least) result.contradicted.push_back(view);
  });
  return result;
}

}  // namespace

void find_uniform_masks(const Exec& exec, Monitor& monitor, const UniformMaskSearch& in, SceneCheck& result) {
  const auto is_full = [](const MaskCheck& masks) {
    return std::ranges::any_of(masks.coverage, [](double share) { return share == 1; });
  };
  std::vector<std::size_t> plain, others;
  for (std::size_t v = 0; v < result.views.size(); ++v) {
    const std::optional<MaskCheck>& masks = result.views[v].masks;
    if (!masks || !(masks->known > 0)) continue;
    const bool is_empty = std::ranges::all_of(masks->coverage, [](double share) { return share == 0; });
    (is_empty || is_full(*masks) ? plain : others).push_back(v);
  }
  result.uniform_masks.views = plain;
  if (in.cloud == nullptr || in.scene.missing_mask == MissingMask::kEmpty) return;
  Scene scene = in.scene;
  scene.compat = result.compat;
  scene.world_unit = result.world_unit;
  result.uniform_masks = check_uniform_masks(
      exec, monitor, {*in.cloud, scene, plain, others, [&](std::size_t view) { return in.loaders.masks(view).masks; }});
  const std::vector<std::size_t>& wrong = result.uniform_masks.contradicted;
  const std::string of_all = " of " + std::to_string(plain.size() + others.size()) + " masks are ";
  const auto full = std::ranges::count_if(wrong, [&](std::size_t v) { return is_full(*result.views[v].masks); });
  const char* kind = full == 0              ? "empty where the other masks show the object ("
                     : full == ssize(wrong) ? "full where the other masks show background ("
                                            : "empty or full where the other masks are not (";
  if (!wrong.empty())
    result.warnings.push_back(std::to_string(wrong.size()) + of_all + kind + some_names(in.scene, wrong) +
                              "): probably the tool that made them lost it; import treats such views as views without "
                              "a mask, --missing-mask empty keeps the masks unchanged");
  else if (result.uniform_masks.agreement < kMinMaskAgreement)
    result.warnings.push_back(std::to_string(plain.size()) + of_all + "empty or full (" + some_names(in.scene, plain) +
                              "), and the others agree too little to decide whether the object is there; view them: "
                              "ngs-scene check SCENE --sheet masks.html");
}

}  // namespace ngs
