#include "ngs/capture/mask_agreement.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "ngs/backend/for_each.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/resize.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/scene/view_sums.h"

namespace ngs {
namespace {

constexpr std::size_t kViews = 16;       // maximum number of compared views
constexpr int kSide_px = 320;            // longest side of the compared images
constexpr std::size_t kMaxObjects = 12;  // maximum number of objects that are compared separately
constexpr double kMostOfImage = 0.5;     // mean coverage of all objects above which only every second one is compared
constexpr int kNearShift = 3, kFarShift = 12;  // views; far shifts are tried if the masks do not fit otherwise
// Mean IoU. Correct masks exceed kFits (less for very thin objects), and no repair improves them.
constexpr double kFits = 0.8, kFitsWell = 0.9;
constexpr double kMinGain = 0.05;      // minimum gain of a repair that makes masks fit
constexpr double kClearGain = 0.4;     // the same for thin objects, for few views, and for single masks
constexpr double kSuspectGain = 0.03;  // gain of shifted or reordered masks above which the masks contradict
constexpr double kLeastBetter =
    1.0 / 3;  // minimum share of improved views: exchanged neighbours improve 1/2 of them, one mask of six 1/6
constexpr double kMaxRatio = 0.75;                  // maximum IoU after a repair / before, if correct masks match badly
constexpr double kApart = 0.5;                      // IoU of a mask below which single masks are repaired
constexpr double kMended = 0.6, kMendedGain = 0.3;  // minimum IoU and gain of a repaired single mask
constexpr double kLowAlone = 0.75;                  // IoU of an object below which its ids are checked
constexpr double kMinTogether = 0.2;                // minimum gain from joining objects whose ids contradict

/// Shifts by `first` to `last` views, in both directions.
std::vector<MaskRepair> shifts(int first, int last) {
  std::vector<MaskRepair> repairs;
  for (int by = first; by <= last; ++by)
    for (const int shift : {by, -by})
      repairs.push_back({.mistake = "shifted by " + std::to_string(shift), .shift = shift});
  return repairs;
}

/// The masks of a view as planes of objects, reduced.
struct SmallMasks {
  int width_px = 0, height_px = 0;
  std::vector<PixelMask> object;  // [K]
};

/// A channel of labels: the mask of a view; empty: the view has none.
using Channel = std::function<PixelMask(std::size_t view)>;

constexpr double kNone = -1;  // IoU of a view that shows the object neither in the mask nor in the labels

class Comparison {
 public:
  Comparison(const Exec& exec, Monitor& monitor, const EvidenceInputs& in) : exec_(exec), monitor_(monitor), in_(in) {
    for (const std::size_t v : in.views)
      if (!in.scene.views[v].mask_path.empty()) masked_.push_back(v);
    compared_ = spread_views(masked_, kViews);
    load(compared_);
    std::erase_if(compared_, [&](std::size_t v) { return !masks_.contains(v); });
    if (in.scene.objects.size() > 1 && cover_most()) pattern_step_ = 2;
  }
  const std::vector<std::size_t>& views() const { return compared_; }

  /// Union of the objects, or of every second one if all cover most of the images: a shift must change the pattern.
  PixelMask pattern(std::size_t view) const { return joined(view, pattern_step_); }
  PixelMask object(std::size_t view, std::size_t k) const { return masks_.at(view).object[k]; }
  PixelMask repaired(std::size_t view, const MaskRepair& repair) const;
  int width_px(std::size_t view) const { return masks_.at(view).width_px; }
  /// Loads the masks that these repairs move to the compared views. Call it first.
  void load_for(const std::vector<MaskRepair>& repairs);
  /// [views()][channels] where the labels that are made from a channel's masks show its object.
  std::vector<std::vector<PixelMask>> shown(const std::vector<Channel>& channels) const;
  /// [channels][views()] IoU of the channel's rendered labels and its masks.
  std::vector<std::vector<double>> iou(const std::vector<Channel>& channels) const;

 private:
  Camera camera_of(std::size_t view) const {
    const Camera& camera = in_.scene.views[view].camera;
    return shrunk(camera, factor_of(camera));
  }
  static int factor_of(const Camera& camera) {
    return (std::max(camera.width_px, camera.height_px) + kSide_px - 1) / kSide_px;
  }
  std::size_t source_of(std::size_t view, const MaskRepair& repair) const {
    const std::size_t n = in_.scene.views.size();
    if (repair.reversed) return n - 1 - view;
    const double source = double(view) * repair.stretch + repair.shift;
    return source >= 0 && source == std::floor(source) ? std::size_t(source) : n;  // n and beyond: no view
  }
  void load(std::vector<std::size_t> needed);
  bool cover_most() const;
  PixelMask joined(std::size_t view, std::size_t step) const;

  const Exec& exec_;
  Monitor& monitor_;
  const EvidenceInputs& in_;
  std::vector<std::size_t> masked_, compared_;
  std::map<std::size_t, SmallMasks> masks_;  // of compared views and of the views that a repair moves to them
  std::size_t pattern_step_ = 1;
};

SmallMasks reduced(const ViewMasks& masks, int factor) {
  SmallMasks small{shrunk_size_px(masks.width_px, factor), shrunk_size_px(masks.height_px, factor), {}};
  for (const std::vector<float>& target : masks.target) {
    ImageF plane(masks.width_px, masks.height_px, 1);
    plane.data = target;
    small.object.push_back(object_pixels(shrunk(plane, factor).data));
  }
  return small;
}

void Comparison::load_for(const std::vector<MaskRepair>& repairs) {
  std::vector<std::size_t> needed;
  for (const std::size_t v : compared_)
    for (const MaskRepair& repair : repairs) needed.push_back(source_of(v, repair));
  load(std::move(needed));
}

void Comparison::load(std::vector<std::size_t> needed) {
  std::ranges::sort(needed);
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  std::erase_if(needed, [&](std::size_t v) { return !std::ranges::binary_search(masked_, v) || masks_.contains(v); });
  std::vector<SmallMasks> loaded(needed.size());
  for_each_task(exec_, std::int64_t(needed.size()), [&](std::int64_t i) {
    const std::size_t v = needed[std::size_t(i)];
    const ViewMasks masks = in_.load_masks(v);
    if (masks.available) loaded[std::size_t(i)] = reduced(masks, factor_of(in_.scene.views[v].camera));
  });
  for (std::size_t i = 0; i < needed.size(); ++i)
    if (!loaded[i].object.empty()) masks_[needed[i]] = std::move(loaded[i]);
}

bool Comparison::cover_most() const {
  double covered = 0, pixels = 0;
  for (const std::size_t view : compared_) {
    const PixelMask all = joined(view, 1);
    covered += double(std::ranges::count(all, 1));
    pixels += double(all.size());
  }
  return covered > kMostOfImage * pixels;
}

PixelMask Comparison::joined(std::size_t view, std::size_t step) const {
  const SmallMasks& masks = masks_.at(view);
  PixelMask all = masks.object[0];
  for (std::size_t k = step; k < masks.object.size(); k += step)
    for (std::size_t p = 0; p < all.size(); ++p) all[p] |= masks.object[k][p];
  return all;
}

PixelMask Comparison::repaired(std::size_t view, const MaskRepair& repair) const {
  const std::size_t source = source_of(view, repair);
  const auto found = masks_.find(source);
  if (found == masks_.end()) return {};
  const Camera camera = camera_of(view);
  return repair.turned(pattern(source), {found->second.width_px, found->second.height_px},
                       {camera.width_px, camera.height_px});
}

std::vector<std::vector<PixelMask>> Comparison::shown(const std::vector<Channel>& channels) const {
  const std::size_t n = std::size_t(in_.cloud.size()), count = channels.size();
  std::vector<float> label(n * count);  // first the excess of weight inside the mask over weight outside
  const SplatOptions splat = prepared_for(exec_, in_.splat, in_.cloud);
  const auto at_size = [&](std::size_t view) {
    return filter_at_scale(splat, 1.0 / factor_of(in_.scene.views[view].camera));
  };
  for_each_view(&monitor_, compared_, [&](std::size_t, std::size_t view) {
    const Camera camera = camera_of(view);
    ViewMasks planes = known_view(camera);
    std::vector<bool> is_masked;
    for (const Channel& channel : channels) {
      const PixelMask mask = channel(view);
      planes.target.emplace_back(mask.begin(), mask.end());
      planes.target.back().resize(std::size_t(camera.width_px) * std::size_t(camera.height_px));
      is_masked.push_back(!mask.empty());
    }
    const ViewSums sums = view_sums(exec_, in_.cloud, {camera, planes}, at_size(view));
    for (std::size_t i = 0; i < sums.size(); ++i)
      for (std::size_t c = 0; c < count; ++c)
        if (is_masked[c]) label[sums.row[i] * count + c] += float(2 * sums.object_weight(i, c) - sums.weight(i));
  });
  std::vector<std::uint8_t> labelled(n);
  for (std::size_t at = 0; at < label.size(); ++at) {
    label[at] = float(label[at] > 0);
    labelled[at / count] |= label[at] > 0;
  }
  std::vector<std::vector<PixelMask>> result(compared_.size(), std::vector<PixelMask>(count));
  for_each_view(&monitor_, compared_, [&](std::size_t v, std::size_t view) {
    RenderRequest request{.colour = false, .label = {label.data(), in_.cloud.size(), int(count)}};
    request.tiles_touching = request.stop_after = labelled.data();
    const ImageF image = render(exec_, in_.cloud, camera_of(view), at_size(view), request).label;
    for (std::size_t at = 0; at < image.data.size(); ++at)
      result[v][at % count].push_back(label_is_foreground(image.data[at]));
  });
  return result;
}

/// The smaller of the IoU of the object and the IoU of the background.
double iou_of(const PixelMask& shown, const PixelMask& mask) {
  MaskOverlap object, rest;
  for (std::size_t p = 0; p < mask.size(); ++p) {
    object.add(shown[p] != 0, mask[p] != 0);
    rest.add(shown[p] == 0, mask[p] == 0);
  }
  return object.either > 0 ? std::min(object.iou(), rest.iou()) : kNone;
}

std::vector<std::vector<double>> Comparison::iou(const std::vector<Channel>& channels) const {
  const auto planes = shown(channels);
  std::vector<std::vector<double>> result(channels.size());
  for (std::size_t v = 0; v < compared_.size(); ++v)
    for (std::size_t c = 0; c < channels.size(); ++c)
      result[c].push_back(iou_of(planes[v][c], channels[c](compared_[v])));
  return result;
}

double mean_of(const std::vector<double>& iou) {
  double sum = 0, views = 0;
  for (const double value : iou)
    if (value != kNone) {
      sum += value;
      views += 1;
    }
  return views > 0 ? sum / views : kNone;
}

/// Means over the views in which both are measured. A systematic mistake affects most views, so a gain in few views,
/// such as by one wrong mask among similar ones, does not count.
RepairedAgreement repaired_agreement(const MaskRepair& repair, const std::vector<double>& given,
                                     const std::vector<double>& iou) {
  std::vector<double> before, after;
  for (std::size_t v = 0; v < iou.size(); ++v)
    if (given[v] != kNone && iou[v] != kNone) {
      before.push_back(given[v]);
      after.push_back(iou[v]);
    }
  const double mean_before = mean_of(before), mean_after = mean_of(after);
  std::size_t better = 0;  // by half of the mean gain or more
  for (std::size_t v = 0; v < after.size(); ++v) better += after[v] - before[v] > 0.5 * (mean_after - mean_before);
  const bool is_common = kLeastBetter * double(after.size()) <= double(better);
  return {repair, after.size(), mean_before, is_common ? mean_after : std::min(mean_before, mean_after)};
}

void measure(Comparison& compare, const std::vector<MaskRepair>& repairs, std::size_t objects, MaskAgreement& found) {
  compare.load_for(repairs);
  std::vector<Channel> channels{[&](std::size_t view) { return compare.pattern(view); }};
  for (const MaskRepair& repair : repairs)
    channels.push_back([&](std::size_t view) { return compare.repaired(view, repair); });
  for (std::size_t k = 0; k < objects; ++k)
    channels.push_back([&compare, k](std::size_t view) { return compare.object(view, k); });
  const std::vector<std::vector<double>> iou = compare.iou(channels);
  found.given = mean_of(iou[0]);
  for (const double value : iou[0])
    if (value != kNone) found.least = std::min(found.least, value);
  for (std::size_t r = 0; r < repairs.size(); ++r)
    if (const RepairedAgreement measured = repaired_agreement(repairs[r], iou[0], iou[1 + r]); repairs[r].inverted)
      found.inverted = measured;
    else if (measured.views > 1)
      found.repaired.push_back(measured);
  for (std::size_t k = 0; k < objects; ++k) found.objects.push_back(mean_of(iou[1 + repairs.size() + k]));
}

void try_repairs(Comparison& compare, MaskAgreement& found) {
  std::vector<MaskRepair> repairs = shifts(1, kNearShift);
  repairs.insert(repairs.end(), mask_repairs().begin(), mask_repairs().end());
  repairs.push_back({.mistake = "in the opposite order", .reversed = true});
  measure(compare, repairs, 0, found);
  const RepairedAgreement* near = found.repair_that_fits();
  if (found.given >= kFits || (near != nullptr && near->after >= kFitsWell)) return;
  repairs = shifts(kNearShift + 1, kFarShift);
  repairs.push_back({.mistake = "made of every frame, for photos of every second one", .stretch = 2});
  repairs.push_back({.mistake = "made of every second photo", .stretch = 0.5});
  measure(compare, repairs, 0, found);
}

/// Compares the union of the objects that match badly: if the union matches well, their ids contradict each other.
void compare_together(const Comparison& compare, MaskAgreement& found) {
  std::vector<std::size_t> low;
  for (std::size_t k = 0; k < found.objects.size(); ++k)
    if (found.objects[k] != kNone && found.objects[k] < kLowAlone) low.push_back(k);
  if (low.size() < 2) return;
  const auto all_of = [&](std::size_t view) {
    PixelMask all = compare.object(view, low[0]);
    for (const std::size_t k : low) {
      const PixelMask mask = compare.object(view, k);
      for (std::size_t p = 0; p < all.size(); ++p) all[p] |= mask[p];
    }
    return all;
  };
  found.together = mean_of(compare.iou({all_of})[0]);
  found.alone = 0;
  for (const std::size_t k : low) found.alone += found.objects[k] / double(low.size());
  found.low = std::move(low);
}

/// Whether a mask covers nearly all of its image's border, as inverted ones do.
bool surrounds(const PixelMask& mask, int width_px) {
  std::size_t covered = 0, border = 0;
  const std::size_t w = std::size_t(width_px);
  for (std::size_t p = 0; p < mask.size(); ++p)
    if (p < w || p + w >= mask.size() || p % w == 0 || p % w == w - 1) {
      ++border;
      covered += mask[p];
    }
  return double(covered) > kAllRound * double(border);
}

/// Repairs single masks: each becomes the repair that fits the labels of all masks best, until none changes. Masks that
/// cover the image's border start inverted: if half of them are inverted, labels cannot tell which.
void repair_single_masks(const Comparison& compare, MaskAgreement& found) {
  constexpr int kMaxRounds = 6;
  std::map<std::size_t, const MaskRepair*> chosen;  // null: as given
  const auto mask = [&](std::size_t view, const MaskRepair* repair) {
    return repair == nullptr ? compare.pattern(view) : compare.repaired(view, *repair);
  };
  const Channel channel = [&](std::size_t view) { return mask(view, chosen[view]); };
  const MaskRepair& inversion = *std::ranges::find_if(mask_repairs(), &MaskRepair::inverted);
  for (const std::size_t view : compare.views())
    if (surrounds(compare.pattern(view), compare.width_px(view))) chosen[view] = &inversion;
  if (chosen.size() == compare.views().size()) chosen.clear();
  bool changes = true;
  for (int round = 0; changes && round < kMaxRounds; ++round) {
    changes = false;
    const auto shown = compare.shown({channel});
    for (std::size_t v = 0; v < compare.views().size(); ++v) {
      const std::size_t view = compare.views()[v];
      const MaskRepair*& best = chosen[view];
      double iou = iou_of(shown[v][0], channel(view));
      const auto consider = [&](const MaskRepair* repair) {
        const double other = iou_of(shown[v][0], mask(view, repair));
        if (!(other > iou + kMinGain)) return;
        iou = other;
        best = repair;
        changes = true;
      };
      consider(nullptr);
      for (const MaskRepair& repair : mask_repairs()) consider(&repair);
    }
  }
  const auto shown = compare.shown({channel});
  std::vector<double> after;
  for (std::size_t v = 0; v < compare.views().size(); ++v) {
    const std::size_t view = compare.views()[v];
    after.push_back(iou_of(shown[v][0], channel(view)));
    const double gain = after.back() - iou_of(shown[v][0], compare.pattern(view));
    if (after.back() >= kMended && gain > kMendedGain) found.single.emplace_back(view, *chosen[view]);
  }
  found.single_after = mean_of(after);
  const auto is_inverted = [](const auto& single) { return single.second.inverted; };
  if (2 * found.single.size() > found.views && !std::ranges::all_of(found.single, is_inverted)) found.single.clear();
}

bool is_of_other_views(const MaskRepair& repair) { return repair.shift != 0 || repair.reversed; }

/// Labels from few views agree with their masks even if these are wrong.
bool is_measured(std::size_t repaired_views, std::size_t views) {
  return repaired_views >= kViews / 2 || 5 * repaired_views >= 3 * views;
}

}  // namespace

const RepairedAgreement* MaskAgreement::best() const {
  const RepairedAgreement* best = nullptr;
  for (const RepairedAgreement& r : repaired)
    if (r.repair.stretch == 1 && is_measured(r.views, views) && (best == nullptr || r.gain() > best->gain())) best = &r;
  return best;
}

const RepairedAgreement* MaskAgreement::repair_that_fits() const {
  const RepairedAgreement* found = nullptr;
  const auto consider = [&](const RepairedAgreement& r) {
    const bool is_clear = r.views > 2 && r.gain() > kClearGain;
    const bool fits =  // half as many masks as given ones agree with each other better, even if wrong
        r.repair.stretch == 1 && r.after >= kFits && r.gain() > kMinGain && is_measured(r.views, views);
    if ((fits || is_clear) && (found == nullptr || r.gain() > found->gain())) found = &r;
  };
  std::ranges::for_each(repaired, consider);
  consider(inverted);
  return found;
}

MaskVerdict MaskAgreement::verdict(const MaskAgreementOptions& options) const {
  if (views == 0 || options.min_mask_agreement < 0) return MaskVerdict::kFit;
  const bool ids_contradict = !low.empty() && together - alone > kMinTogether;
  if (const RepairedAgreement* repair = repair_that_fits(); repair && (repair->after >= kFits || !ids_contradict))
    return MaskVerdict::kRepairable;
  if (ids_contradict) return MaskVerdict::kIdsContradict;
  if (!single.empty() && single_after - given > kClearGain) return MaskVerdict::kContradict;
  const RepairedAgreement* other = best();
  for (const RepairedAgreement& r : repaired)
    if (is_of_other_views(r.repair) && r.views >= kViews / 2 && r.gain() > kSuspectGain)
      return MaskVerdict::kContradict;
  const bool is_hard = other != nullptr && other->after < kMaxRatio * other->before;
  return given < options.min_mask_agreement && !is_hard ? MaskVerdict::kContradict : MaskVerdict::kFit;
}

MaskAgreement measure_mask_agreement(const Exec& exec, Monitor& monitor, const EvidenceInputs& in) {
  const auto timed = monitor.scope("mask agreement");
  Comparison compare(exec, monitor, in);
  MaskAgreement found;
  const auto is_partial = [&](std::size_t view) {
    const PixelMask mask = compare.pattern(view);
    return std::ranges::count(mask, mask[0]) < std::ssize(mask);
  };
  if (compare.views().size() < 2 || std::ranges::none_of(compare.views(), is_partial) ||
      std::ranges::count(in.cloud.usable, 1) == 0)
    return found;
  found.views = compare.views().size();
  measure(compare, {}, in.scene.objects.size() > 1 ? std::min(in.scene.objects.size(), kMaxObjects) : 0, found);
  if (found.given <= 1 - kSuspectGain) try_repairs(compare, found);  // beyond, no repair can gain enough
  compare_together(compare, found);
  if (found.least < kApart && in.scene.objects.size() == 1 && in.scene.mask_mode != MaskMode::kLabel)
    repair_single_masks(compare, found);
  return found;
}

}  // namespace ngs
