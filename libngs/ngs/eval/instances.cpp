#include "ngs/eval/instances.h"

#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/ops/image/pixel_window.h"

namespace ngs {
namespace {

/// Segments that overlap, by index into InstanceScores::predicted and ::truth.
struct Overlap {
  std::size_t predicted, truth;
  double iou, of_predicted, of_truth;  // shares
};

template <class Instance>
std::size_t index_of(const std::vector<Instance>& list, std::uint32_t id) {
  return std::size_t(std::ranges::lower_bound(list, id, {}, &Instance::id) - list.begin());
}

template <class Instance>
std::vector<Instance> sized(const std::map<std::uint32_t, std::uint64_t>& sizes) {
  std::vector<Instance> list;
  for (const auto& [id, pixels] : sizes) {
    list.emplace_back();
    list.back().id = id;
    list.back().pixels = pixels;
  }
  return list;
}

std::vector<Overlap> overlaps_of(const InstanceCounts& counts, const InstanceScores& s) {
  std::vector<Overlap> overlaps;
  for (const auto& [ids, pixels] : counts.pixels()) {
    if (ids.first == 0 || ids.second == 0) continue;
    const std::size_t p = index_of(s.predicted, ids.first), t = index_of(s.truth, ids.second);
    const double shared = double(pixels), a = double(s.predicted[p].pixels), b = double(s.truth[t].pixels);
    overlaps.push_back({p, t, shared / (a + b - shared), shared / a, shared / b});
  }
  return overlaps;
}

/// `overlaps` in the order of their predictions, by id.
double average_precision(const InstanceScores& s, const std::vector<Overlap>& overlaps, double least_iou) {
  std::vector<std::size_t> order(s.predicted.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, std::greater<>{}, [&](std::size_t i) { return s.predicted[i].pixels; });
  std::vector<std::uint8_t> taken(s.truth.size(), 0);
  std::vector<double> precision;  // at each true positive
  double hits = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Overlap* best = nullptr;
    for (auto o = std::ranges::lower_bound(overlaps, order[k], {}, &Overlap::predicted);
         o != overlaps.end() && o->predicted == order[k]; ++o)
      if (o->iou >= least_iou && !taken[o->truth] && (best == nullptr || o->iou > best->iou)) best = &*o;
    if (best == nullptr) continue;
    taken[best->truth] = 1;
    precision.push_back(++hits / double(k + 1));
  }
  double area = 0, most = 0;
  for (std::size_t i = precision.size(); i-- > 0;) {
    most = std::max(most, precision[i]);
    area += most;
  }
  return area / double(s.truth.size());
}

void find_errors(const InstanceCounts& counts, const std::vector<Overlap>& overlaps, InstanceScores& s) {
  constexpr double kHalf = 0.5, kPart = 0.1;
  std::vector<int> parts(s.truth.size(), 0);
  for (const Overlap& o : overlaps) {
    if (o.of_truth > kHalf) s.predicted[o.predicted].merged.push_back(s.truth[o.truth].id);
    parts[o.truth] += o.of_predicted > kHalf && o.of_truth >= kPart;
  }
  for (const auto& [ids, pixels] : counts.pixels()) {
    if (ids.first == 0 && ids.second != 0) {
      TrueInstance& truth = s.truth[index_of(s.truth, ids.second)];
      truth.missed = double(pixels) > kHalf * double(truth.pixels);
    }
    if (ids.first != 0 && ids.second == 0) {
      PredictedInstance& predicted = s.predicted[index_of(s.predicted, ids.first)];
      predicted.invented = double(pixels) > kHalf * double(predicted.pixels);
    }
  }
  for (PredictedInstance& predicted : s.predicted) {
    if (predicted.merged.size() < 2) predicted.merged.clear();
    s.merged += !predicted.merged.empty();
    s.invented += predicted.invented;
  }
  for (std::size_t t = 0; t < s.truth.size(); ++t) {
    s.truth[t].split = parts[t] >= 2;
    s.split += s.truth[t].split;
    s.missed += s.truth[t].missed;
  }
}

}  // namespace

void InstanceCounts::add(std::span<const std::uint32_t> predicted, std::span<const std::uint32_t> truth,
                         std::span<const std::uint8_t> is_void) {
  NGS_CHECK(predicted.size() == truth.size() && (is_void.empty() || is_void.size() == truth.size()),
            "instances: one predicted and one true id per pixel");
  for (std::size_t i = 0; i < truth.size();) {
    std::size_t end = i;  // runs of equal pairs
    while (end < truth.size() && predicted[end] == predicted[i] && truth[end] == truth[i] &&
           (is_void.empty() || is_void[end] == is_void[i]))
      ++end;
    if (is_void.empty() || !is_void[i]) pixels_[{predicted[i], truth[i]}] += end - i;
    i = end;
  }
}

void InstanceCounts::add(const InstanceCounts& other) {
  for (const auto& [ids, pixels] : other.pixels_) pixels_[ids] += pixels;
}

InstanceScores score_instances(const InstanceCounts& counts) {
  std::map<std::uint32_t, std::uint64_t> predicted, truth;
  for (const auto& [ids, pixels] : counts.pixels()) {
    if (ids.first != 0) predicted[ids.first] += pixels;
    if (ids.second != 0) truth[ids.second] += pixels;
  }
  if (truth.empty())
    throw Error(ErrorCode::kNothingFound, "true id maps: no object, expected ids above 0",
                "check the folder of true id maps and --void-id");
  InstanceScores s;
  s.predicted = sized<PredictedInstance>(predicted);
  s.truth = sized<TrueInstance>(truth);
  const std::vector<Overlap> overlaps = overlaps_of(counts, s);
  for (const Overlap& o : overlaps) {
    TrueInstance& t = s.truth[o.truth];
    if (o.iou <= t.iou) continue;
    t.iou = o.iou;
    t.best = s.predicted[o.predicted].id;
  }
  for (const TrueInstance& t : s.truth) {
    if (!t.matched()) continue;
    ++s.matched;
    s.sq += t.iou;
    s.predicted[index_of(s.predicted, t.best)].match = t.id;
  }
  if (s.matched > 0) s.sq /= double(s.matched);
  s.rq = double(s.matched) / (0.5 * double(s.predicted.size() + s.truth.size()));
  s.pq = s.sq * s.rq;
  s.ap25 = average_precision(s, overlaps, 0.25);
  s.ap50 = average_precision(s, overlaps, 0.5);
  for (int k = 0; k < 10; ++k) s.ap += 0.1 * average_precision(s, overlaps, 0.5 + 0.05 * k);
  find_errors(counts, overlaps, s);
  return s;
}

double instance_biou(std::span<const std::uint32_t> predicted_ids, std::span<const std::uint32_t> true_ids,
                     int width_px, const TrueInstance& instance) {
  const int height_px = int(true_ids.size()) / width_px;
  const auto is_in = [&](std::size_t i) { return predicted_ids[i] == instance.best || true_ids[i] == instance.id; };
  // A frame of one pixel, where the image has one, keeps every distance.
  const PixelWindow win = window_about(box_where(width_px, height_px, is_in), 1, width_px, height_px);
  if (win.w == 0) return -1;
  std::vector<std::uint8_t> predicted, truth;
  for (int y = win.y0; y < win.y0 + win.h; ++y)
    for (int x = win.x0; x < win.x0 + win.w; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width_px) + std::size_t(x);
      predicted.push_back(predicted_ids[i] == instance.best);
      truth.push_back(true_ids[i] == instance.id);
    }
  return boundary_iou({}, chessboard_distance({predicted.data(), win.w, win.h}),
                      chessboard_distance({truth.data(), win.w, win.h}), win.w,
                      band_width_px(0.02, width_px, height_px));
}

}  // namespace ngs
