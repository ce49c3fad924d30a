#include "ngs/cut/groups/view_gaussians.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/splat/evidence.h"

namespace ngs {
namespace {

/// Number of masks whose planes are in memory at once.
constexpr int kPlanes = 64;

/// The masks first + 1 .. first + kPlanes as planes.
ViewMasks planes_of(const NumberedMasks& masks, int first) {
  const std::vector<std::uint16_t>& number = masks.number.data;
  ViewMasks planes{masks.number.width_px, masks.number.height_px, {}, {}, true};
  planes.target.assign(std::size_t(std::min(kPlanes, masks.masks - first)), std::vector<float>(number.size()));
  if (std::ranges::find(number, NumberedMasks::kUnknown) != number.end()) planes.known.resize(number.size());
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (!planes.known.empty()) planes.known[p] = number[p] != NumberedMasks::kUnknown;
    const int plane = int(number[p]) - 1 - first;
    if (plane >= 0 && plane < int(planes.target.size())) planes.target[std::size_t(plane)][p] = 1;
  }
  return planes;
}

}  // namespace

ViewGaussians view_gaussians(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                             const SplatOptions& splat, const NumberedMasks& masks) {
  ViewGaussians out{masks.masks, {}};
  if (masks.number.empty()) return out;
  std::vector<HeaviestMask> all;
  for (int first = 0; first == 0 || first < masks.masks; first += kPlanes) {
    const ViewMasks planes = planes_of(masks, first);
    std::vector<HeaviestMask> some = heaviest_masks(exec, cloud, {camera, planes}, splat);
    for (HeaviestMask& of : some)
      if (of.object >= 0) of.object += first;
    if (all.empty()) {
      all = std::move(some);
      continue;
    }
    NGS_CHECK(some.size() == all.size(), "the same Gaussians for each part of the masks");
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].of_all += some[i].of_all;
      if (some[i].of_object <= all[i].of_object) continue;
      all[i].of_object = some[i].of_object;
      all[i].object = some[i].object;
    }
  }
  for (const HeaviestMask& of : all) {
    const bool outside = of.weight - of.of_all > 0.5 * of.weight;
    if (!outside && !(of.of_object > 0.5 * of.weight)) continue;
    out.seen.push_back({of.row, outside ? 0 : std::uint32_t(of.object) + 1, float(of.weight),
                        float(of.weight / std::max(of.pixels, 1.0))});
  }
  std::ranges::sort(out.seen, {}, &MaskedGaussian::gaussian);
  return out;
}

void keep_unhidden(const Exec& exec, std::size_t gaussians, double share, std::vector<ViewGaussians>& views) {
  std::vector<float> largest(gaussians);
  for (const ViewGaussians& view : views)
    for (const MaskedGaussian& of : view.seen) largest[of.gaussian] = std::max(largest[of.gaussian], of.visibility);
  for_each_task(exec, std::ssize(views), [&](std::int64_t v) {
    std::vector<MaskedGaussian>& seen = views[std::size_t(v)].seen;
    std::erase_if(seen, [&](const MaskedGaussian& of) { return of.visibility < float(share) * largest[of.gaussian]; });
    seen.shrink_to_fit();
  });
}

}  // namespace ngs
