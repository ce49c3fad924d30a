#include "ngs/capture/mask_check.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "ngs/capture/mask_repair.h"
#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

/// Sums over one object's mask in one view.
struct PlaneSums {
  double object = 0, known = 0;                // pixels
  double single = 0;                           // pixels that differ from their four neighbours
  double border_object = 0, border_known = 0;  // pixels of the outermost rows and columns
};

PlaneSums sum_plane(const ViewMasks& masks, std::size_t object) {
  PlaneSums sums;
  const std::vector<float>& target = masks.target[object];
  for (int y = 0; y < masks.height_px; ++y)
    for (int x = 0; x < masks.width_px; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(masks.width_px) + std::size_t(x);
      if (!masks.known.empty() && masks.known[i] == 0) continue;
      sums.object += double(target[i]);
      sums.known += 1;
      if (x > 0 && y > 0 && x + 1 < masks.width_px && y + 1 < masks.height_px) {
        const std::size_t w = std::size_t(masks.width_px);
        const bool is_set = mask_is_foreground(target[i]);
        sums.single += std::ranges::none_of(std::array{i - 1, i + 1, i - w, i + w},
                                            [&](std::size_t n) { return mask_is_foreground(target[n]) == is_set; });
        continue;
      }
      sums.border_object += double(target[i]);
      sums.border_known += 1;
    }
  return sums;
}

/// The box of a mask that is an upright rectangle within the picture; empty: another mask.
ForegroundBox rectangle_of(const ViewMasks& masks, std::size_t object, double object_px) {
  constexpr int kLeastSide_px = 8;
  const ForegroundBox box = foreground_box(masks.target[object], masks.width_px, masks.height_px);
  const int w = box.x1 - box.x0, h = box.y1 - box.y0;
  const bool is_box = std::min(w, h) >= kLeastSide_px && object_px >= double(w) * double(h) && w < masks.width_px &&
                      h < masks.height_px;
  return is_box ? box : ForegroundBox{};
}

void add_view(const ViewMasks& masks, std::size_t v, SceneCheck& result) {
  MaskCheck& check = result.views[v].masks.emplace();
  std::vector<ObjectCheck>& objects = result.objects;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const PlaneSums sums = sum_plane(masks, k);
    const double coverage = sums.known > 0 ? sums.object / sums.known : 0;
    check.known = sums.known / double(masks.target[k].size());
    check.coverage.push_back(coverage);
    ObjectCheck& object = objects[k];
    ++object.views;
    object.empty += sums.object == 0;
    object.full += sums.known > 0 && sums.object == sums.known;
    object.single += sums.known > 0 ? sums.single / sums.known : 0;
    if (const ForegroundBox box = rectangle_of(masks, k, sums.object); !box.empty()) {
      ++object.rectangles;
      object.rectangle_view = v;
      object.rectangle_px = {box.x0, box.y0, box.x1, box.y1};
    }
    if (masks.target.size() > 1) {
      const auto* bytes = reinterpret_cast<const char*>(masks.target[k].data());
      object.hash = 31 * object.hash + std::hash<std::string_view>()({bytes, masks.target[k].size() * sizeof(float)});
    }
    object.mean_coverage += coverage;
    const double border = sums.border_known > 0 ? sums.border_object / sums.border_known : 0;
    object.border += border;
    object.all_round += border > kAllRound;
    object.inside += sums.object > 0 && border < 1 - kAllRound;
  }
}

/// One warning per kind of note, with the number of files.
class Notes {
 public:
  void add(const std::string& note) {
    const std::size_t colon = note.find(": ");
    Entry& entry = by_text_[colon == std::string::npos ? note : note.substr(colon + 2)];
    if (entry.count++ == 0) entry.first = note;
  }
  void write_to(std::vector<std::string>& warnings) const {
    for (const auto& [text, entry] : by_text_)
      warnings.push_back(entry.count == 1 ? entry.first
                                          : std::to_string(entry.count) + " masks: " + text +
                                                " (first: " + entry.first.substr(0, entry.first.find(": ")) + ")");
  }

 private:
  struct Entry {
    int count = 0;
    std::string first;
  };
  std::map<std::string, Entry> by_text_;
};

void check_coverage(const std::string& name, const ObjectCheck& object, MaskMode mode,
                    std::vector<std::string>& warnings) {
  const std::string prefix = "object " + name + ": ";
  const std::string all =
      object.views == 1 ? "its only mask is " : "all its " + std::to_string(object.views) + " masks are ";
  if (object.views > 0 && object.empty == object.views)
    throw Error(ErrorCode::kInconsistent, prefix + all + "empty, expected the object in some",
                "wrong --object-id, --mask-threshold or polarity (--mask-invert)? Maps of ids need --mask-mode label");
  if (object.views > 0 && object.full == object.views)
    throw Error(ErrorCode::kInconsistent, prefix + all + "full, expected background in some",
                mode == MaskMode::kBands
                    ? "--mask-mode bands reads black as unknown: leave it out for masks in black and white"
                    : "wrong --mask-threshold or polarity (--mask-invert)? Masks of valid pixels, as a mask_path of "
                      "nerfstudio, are not those of an object: --masks DIR");
  if (object.full > 0)
    warnings.push_back(prefix + std::to_string(object.full) + " of " + std::to_string(object.views) +
                       " masks are full");
}

/// Masks that locate the object without its outline, or with noise around it.
void check_shapes(const Scene& scene, std::size_t k, SceneCheck& result) {
  constexpr double kNoise = 0.005;  // of the pixels; see docs/decisions/labels.md
  constexpr int kFewestRectangles = 3;
  const ObjectCheck& object = result.objects[k];
  const std::string prefix = "object " + scene.objects[k].name + ": ";
  if (object.single > kNoise)
    result.warnings.push_back(
        prefix + percent(object.single) +
        " of the pixels of its masks differ from all their neighbours: noise; to remove it: mkdir "
        "masks-clean; mogrify -path masks-clean -statistic median 3x3 MASKS/*.png; then "
        "--masks masks-clean");
  if (object.rectangles < kFewestRectangles || object.rectangles < object.views - object.empty - object.full) return;
  const Camera& camera = scene.views[object.rectangle_view].camera;
  std::string box;
  for (const int px : object.rectangle_px) box += (box.empty() ? "" : ", ") + std::to_string(px);
  result.warnings.push_back(prefix +
                            "all its masks are upright rectangles, such as boxes of a detector, not its outline; "
                            "use a box as a prompt: --strokes FILE with {\"ngs_prompts\": 1, \"view\": \"" +
                            camera.name + "\", \"width\": " + std::to_string(camera.width_px) +
                            ", \"height\": " + std::to_string(camera.height_px) + ", \"boxes\": [[" + box + "]]}");
}

/// Masks of an object normally cover less than half of the images and of their borders.
void check_polarity(const Scene& scene, std::size_t k, bool refuses, SceneCheck& result) {
  constexpr double kMaxBorder = 0.5, kMaxCoverage = 0.5;
  const ObjectCheck& object = result.objects[k];
  if (!(object.border > kMaxBorder && (object.mean_coverage > kMaxCoverage || object.border > kAllRound))) return;
  const bool is_frame = object.mean_coverage <= kMaxCoverage;
  const std::string found = "object " + scene.objects[k].name + ": its masks cover " +
                            (is_frame ? "nearly all borders of the images" : "most of the images and of their borders");
  if (scene.mask_mode == MaskMode::kLabel)
    return result.warnings.push_back(found + "; if its id is the background's, choose another with --object-id");
  if (scene.mask_invert)
    return result.warnings.push_back(found + "; if white means the object, leave --mask-invert out");
  // Many masks cover the border and many do not: single masks are inverted, and ngs-variance names them.
  if (3 * std::min(object.all_round, object.inside) >= object.views) return;
  const std::string remedy = std::string("if white means background, use --mask-invert") +
                             (is_frame ? "; if a frame was drawn around them, remove it" : "");
  if (refuses && scene.objects.size() == 1)
    throw Error(ErrorCode::kInconsistent, found + ", expected less than half: they look inverted",
                remedy + "; if the object is so large, --no-check-polarity");
  result.warnings.push_back(found + "; " + remedy);
}

/// Warns about objects with identical masks, such as the folders of two runs of a tool.
void check_twins(const Scene& scene, SceneCheck& result) {
  std::map<std::size_t, std::vector<std::string>> twins;
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (result.objects[k].views > result.objects[k].empty)
      twins[result.objects[k].hash].push_back(scene.objects[k].name);
  for (const auto& [hash, names] : twins)
    if (names.size() > 1)
      result.warnings.push_back("objects " + listed(names, 4) + ": their masks are the same; to cut one: --object-id " +
                                names[0]);
}

}  // namespace

void check_masks(Monitor& monitor, const MaskCheckInputs& in, SceneCheck& result) {
  const auto& [scene, loaders, refuses_inverted] = in;
  const auto timed = monitor.scope("masks");
  result.objects.resize(scene.objects.size());
  Notes notes;
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    if (scene.views[i].split == Split::kHeldOut) continue;
    const MaskSample sample = loaders.masks(i);
    for (const std::string& note : sample.notes) notes.add(note);
    if (sample.lossy) notes.add(scene.views[i].mask_path + ": JPEG, compression moves the contours (use PNG)");
    if (!sample.masks.available || scene.views[i].mask_path.empty()) continue;
    NGS_CHECK(sample.masks.target.size() == scene.objects.size(), "one mask plane per object");
    add_view(sample.masks, i, result);
    monitor.progress(std::int64_t(i) + 1, std::int64_t(scene.views.size()));
  }
  notes.write_to(result.warnings);
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    ObjectCheck& object = result.objects[k];
    if (object.views > 0) {
      object.mean_coverage /= object.views;
      object.border /= object.views;
      object.single /= object.views;
    }
    check_coverage(scene.objects[k].name, object, scene.mask_mode, result.warnings);
    check_polarity(scene, k, refuses_inverted, result);
    check_shapes(scene, k, result);
  }
  check_twins(scene, result);
}

}  // namespace ngs
