#include "result_check.h"

#include <algorithm>
#include <optional>

#include "cut_inputs.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/view_names.h"

namespace ngs::ngs_tool {
namespace {

// IoU of right masks at least .81 (a draft of six views of 96x72) and .97 (two recipes, 12 views); 3 px too large or
// too small in 160x120 .65. Cropped to three quarters .33 to .39; of two exchanged masks of six .17 and .26.
constexpr double kApart = 0.5;

/// Of a mask of the result and a given one, at the size of the given one.
MaskOverlap overlap_of(const MaskSamples& result, const ViewMasks& given, std::size_t object) {
  const std::vector<std::uint8_t> shown = object_pixels(result);
  const std::size_t w = std::size_t(given.width_px), h = std::size_t(given.height_px);
  const std::size_t from_w = std::size_t(result.width_px), from_h = std::size_t(result.height_px);
  MaskOverlap overlap;
  for (std::size_t y = 0; y < h; ++y)
    for (std::size_t x = 0; x < w; ++x) {
      const std::size_t p = y * w + x;
      if (!given.known.empty() && given.known[p] == 0) continue;
      const std::size_t from = (y * from_h + from_h / 2) / h * from_w + (x * from_w + from_w / 2) / w;
      overlap.add(shown[from] != 0, is_set(given.target[object][p]));
    }
  return overlap;
}

}  // namespace

ResultAgreement compare_with_masks(const Scene& scene, const std::string& folder) {
  const std::vector<std::string> names = output_names(scene.views);
  ResultAgreement found;
  std::vector<double> all;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    if (scene.views[v].mask_path.empty()) continue;
    std::optional<ViewMasks> given;
    for (std::size_t k = 0; k < scene.objects.size(); ++k) {
      const std::string& object = scene.objects[k].name;
      const bool is_alone = scene.objects.size() == 1;
      const std::string path = folder + "/" + (is_alone ? "" : object + "/") + names[v] + ".png";
      if (!exists(path)) continue;
      if (!given) given = io::load_masks(scene, v);
      if (!given->available) continue;
      const io::RawMask result = io::read_mask_raw(path, io::Palette::kMask);
      const MaskOverlap overlap = overlap_of(result.samples(), *given, k);
      if (overlap.either == 0) continue;
      all.push_back(overlap.iou());
      found.least = std::min(found.least, all.back());
      if (all.back() < kApart)
        found.apart.push_back(scene.views[v].camera.name + (is_alone ? "" : " (" + object + ")"));
    }
  }
  found.masks = all.size();
  if (all.empty()) return found;
  std::ranges::sort(all);
  found.median = all[all.size() / 2];
  return found;
}

std::string ResultAgreement::text() const {
  constexpr std::size_t kListed = 4;
  if (apart.empty()) return {};
  const std::string where = listed(apart, kListed);
  if (2 * apart.size() > masks)
    return "the result disagrees with its masks: IoU " + formatted("%.2f", median) + " in the median of " +
           std::to_string(masks) + ", expected more than 0.5: these masks may be cropped, or of other photos";
  return "the result disagrees with " + std::to_string(apart.size()) + " of " + std::to_string(masks) +
         " masks, IoU down to " + formatted("%.2f", least) + ": " + where + "; look at them and leave out wrong ones";
}

}  // namespace ngs::ngs_tool
