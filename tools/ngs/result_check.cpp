#include "result_check.h"

#include <algorithm>
#include <map>
#include <optional>

#include "cut_inputs.h"
#include "ngs/capture/mask_repair.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/view_names.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::ngs_tool {
namespace {

// Measured IoU. Correct masks: from 0.81 (draft, six views of 96x72), from 0.97 (two recipes, 12 views). 3 px too large
// or small at 160x120: 0.65. Cropped to three quarters: 0.33 to 0.39. Two exchanged masks of six: 0.17, 0.26.
constexpr double kApart = 0.5;
constexpr std::size_t kListed = 4, kExamined = 32;  // masks
constexpr double kMinMended = 0.6, kMinGain = 0.3;  // IoU, of a mask with its mistake undone

/// A mask of the result and a given one, at the size of the given one; unknown pixels are 0 in both.
struct MaskPlanes {
  std::string name;
  MaskRepair::Size size;
  PixelMask shown, given;
};

MaskPlanes planes_of(const MaskSamples& result, const ViewMasks& given, std::size_t object) {
  const PixelMask shown = object_pixels(result);
  const std::size_t w = std::size_t(given.width_px), h = std::size_t(given.height_px);
  const std::size_t from_w = std::size_t(result.width_px), from_h = std::size_t(result.height_px);
  MaskPlanes planes{{}, {given.width_px, given.height_px}, {}, {}};
  for (std::size_t y = 0; y < h; ++y)
    for (std::size_t x = 0; x < w; ++x) {
      const std::size_t p = y * w + x;
      const bool known = given.known.empty() || given.known[p] != 0;
      const std::size_t from = (y * from_h + from_h / 2) / h * from_w + (x * from_w + from_w / 2) / w;
      planes.shown.push_back(known && shown[from] != 0);
      planes.given.push_back(known && is_set(given.target[object][p]));
    }
  return planes;
}

MaskOverlap overlap_of(const PixelMask& a, const PixelMask& b) {
  MaskOverlap overlap;
  for (std::size_t p = 0; p < a.size(); ++p) overlap.add(a[p] != 0, b[p] != 0);
  return overlap;
}

/// The usual mistake whose repair makes a given mask fit the result; empty: none. `all`: all masks that do not fit.
std::string mistake_of(const MaskPlanes& mask, const std::vector<MaskPlanes>& all) {
  std::string found;
  double best = std::max(kMinMended, overlap_of(mask.shown, mask.given).iou() + kMinGain);
  const auto consider = [&](const std::string& mistake, const PixelMask& mended) {
    const double iou = overlap_of(mask.shown, mended).iou();
    if (iou > best) {
      best = iou;
      found = mistake;
    }
  };
  for (const MaskRepair& repair : mask_repairs())
    consider(repair.mistake + " (mogrify " + repair.mogrify + ")", repair.turned(mask.given, mask.size, mask.size));
  for (const MaskPlanes& other : all)
    if (&other != &mask && other.size == mask.size) consider("the mask of " + other.name, other.given);
  return found;
}

bool is_at_border(std::size_t pixel, std::size_t width_px, std::size_t pixels) {
  const std::size_t x = pixel % width_px;
  return x == 0 || x + 1 == width_px || pixel < width_px || pixel + width_px >= pixels;
}

/// "0000.png, 0002.png: mirrored (...); 0001.png: ..."; empty: no usual mistake.
std::string mistakes_of(const std::vector<MaskPlanes>& apart) {
  std::map<std::string, std::vector<std::string>> names;
  for (const MaskPlanes& mask : apart)
    if (const std::string mistake = mistake_of(mask, apart); !mistake.empty()) names[mistake].push_back(mask.name);
  std::string text;
  for (const auto& [mistake, of] : names) text += (text.empty() ? "" : "; ") + listed(of, kListed) + ": " + mistake;
  return text;
}

}  // namespace

ResultAgreement compare_with_masks(const Scene& scene, const std::string& folder) {
  const std::vector<std::string> names = output_names(scene.views);
  ResultAgreement found;
  std::vector<double> all;
  std::vector<MaskPlanes> apart;
  std::int64_t border = 0, covered = 0;  // pixels
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
      MaskPlanes planes = planes_of(result.samples(), *given, k);
      const MaskOverlap overlap = overlap_of(planes.shown, planes.given);
      if (overlap.either == 0) continue;
      for (std::size_t p = 0; p < planes.shown.size(); ++p)
        if (is_at_border(p, std::size_t(planes.size.width_px), planes.shown.size())) {
          ++border;
          covered += planes.shown[p];
        }
      all.push_back(overlap.iou());
      found.least = std::min(found.least, all.back());
      if (all.back() >= kApart) continue;
      planes.name = scene.views[v].camera.name + (is_alone ? "" : " (" + object + ")");
      found.apart.push_back(planes.name);
      if (apart.size() < kExamined) apart.push_back(std::move(planes));
    }
  }
  found.mistakes = mistakes_of(apart);
  found.masks = all.size();
  found.covers_borders = 2 * covered > border;
  if (all.empty()) return found;
  std::ranges::sort(all);
  found.median = all[all.size() / 2];
  return found;
}

std::string ResultAgreement::text() const {
  if (apart.empty()) return {};
  const std::string where = listed(apart, kListed);
  if (2 * apart.size() > masks)
    return "the result disagrees with its masks: IoU " + formatted("%.2f", median) + " in the median of " +
           std::to_string(masks) + ", expected more than 0.5: " +
           (mistakes.empty() ? "these masks may be cropped, or of other photos"
                             : "they fit with one mistake undone: " + mistakes);
  return "the result disagrees with " + std::to_string(apart.size()) + " of " + std::to_string(masks) +
         " masks, IoU down to " + formatted("%.2f", least) + ": " + where +
         (mistakes.empty() ? "; look at them and leave out wrong ones"
                           : "; they fit with one mistake undone: " + mistakes);
}

}  // namespace ngs::ngs_tool
