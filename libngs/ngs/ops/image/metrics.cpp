#include "ngs/ops/image/metrics.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/ops/losses/photometric.h"

namespace ngs {
namespace {

double ratio_or(std::uint64_t part, std::uint64_t whole, double if_nothing) {
  return whole == 0 ? if_nothing : double(part) / double(whole);
}

void require_same_size(MaskPlane a, MaskPlane b) {
  NGS_CHECK(a.width_px == b.width_px && a.height_px == b.height_px,
            "masks of a pair differ in size: " + std::to_string(a.width_px) + "x" + std::to_string(a.height_px) +
                " and " + std::to_string(b.width_px) + "x" + std::to_string(b.height_px));
}

struct ConfusionRow {
  MaskPlane predicted, truth;
  Confusion* row;  // [H] out
  void operator()(std::int64_t y) const {
    const std::uint8_t* p = predicted.data + y * predicted.width_px;
    const std::uint8_t* t = truth.data + y * truth.width_px;
    std::uint64_t both = 0, p_count = 0, t_count = 0;
    for (int x = 0; x < predicted.width_px; ++x) {
      both += p[x] != 0 && t[x] != 0;
      p_count += p[x] != 0;
      t_count += t[x] != 0;
    }
    const std::uint64_t width = std::uint64_t(predicted.width_px);
    row[y] = {both, p_count - both, t_count - both, width + both - p_count - t_count};
  }
};

struct BandRow {
  const std::int32_t *predicted, *truth;  // [H·W] distances
  std::int64_t width_px;
  std::int32_t band_px;
  std::uint64_t *common, *any;  // [H] out
  void operator()(std::int64_t y) const {
    std::uint64_t in_both = 0, in_any = 0;
    for (std::int64_t i = y * width_px; i < (y + 1) * width_px; ++i) {
      const bool p = predicted[i] > 0 && predicted[i] <= band_px, t = truth[i] > 0 && truth[i] <= band_px;
      in_both += p && t;
      in_any += p || t;
    }
    common[y] = in_both;
    any[y] = in_any;
  }
};

bool on_contour(MaskPlane mask, int x, int y) {
  const std::uint8_t* at = mask.data + std::int64_t(y) * mask.width_px + x;
  if (*at == 0) return false;
  return (x > 0 && at[-1] == 0) || (x + 1 < mask.width_px && at[1] == 0) || (y > 0 && at[-mask.width_px] == 0) ||
         (y + 1 < mask.height_px && at[mask.width_px] == 0);
}

std::vector<std::uint8_t> contour_of(MaskPlane mask) {
  std::vector<std::uint8_t> contour;
  contour.reserve(std::size_t(mask.pixels()));
  for (int y = 0; y < mask.height_px; ++y)
    for (int x = 0; x < mask.width_px; ++x) contour.push_back(on_contour(mask, x, y));
  return contour;
}

/// Vertical distance to the nearest set pixel of the same column, `kUnbounded` where the column has none.
std::vector<std::int32_t> column_distance(const std::vector<std::uint8_t>& set, int width_px, int height_px) {
  std::vector<std::int32_t> distance(set.size(), kUnbounded);
  const auto relax = [&](std::size_t i, std::size_t from) {
    if (distance[from] < kUnbounded) distance[i] = std::min(distance[i], distance[from] + 1);
  };
  const std::size_t w = std::size_t(width_px), h = std::size_t(height_px);
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set[i])
      distance[i] = 0;
    else if (i >= w)
      relax(i, i - w);
  }
  for (std::size_t i = h < 2 ? 0 : w * (h - 1); i-- > 0;) relax(i, i + w);
  return distance;
}

struct Matched {
  std::uint64_t matched = 0, total = 0;
};

/// How many pixels of `contour` have a pixel of the other contour within the tolerance (Euclidean).
Matched match(const std::vector<std::uint8_t>& contour, const std::vector<std::int32_t>& other_column_distance,
              int width_px, int tolerance_px) {
  Matched count;
  const std::int64_t r2 = std::int64_t(tolerance_px) * tolerance_px;
  for (std::size_t i = 0; i < contour.size(); ++i) {
    if (!contour[i]) continue;
    ++count.total;
    const int x = int(i % std::size_t(width_px));
    const int first = std::max(-x, -tolerance_px), last = std::min(width_px - 1 - x, tolerance_px);
    for (int dx = first; dx <= last; ++dx) {
      const std::int64_t dy = other_column_distance[std::size_t(std::int64_t(i) + dx)];
      if (dy <= tolerance_px && dx * dx + dy * dy <= r2) {
        ++count.matched;
        break;
      }
    }
  }
  return count;
}

/// The truth, with the prediction in void pixels.
std::vector<std::uint8_t> closest_truth(MaskPlane predicted, MaskPlane truth, MaskPlane is_void) {
  std::vector<std::uint8_t> closest(truth.data, truth.data + truth.pixels());
  for (std::size_t i = 0; i < closest.size(); ++i)
    if (is_void.data[i]) closest[i] = predicted.data[i];
  return closest;
}

std::uint64_t count_set(MaskPlane mask) {
  std::uint64_t count = 0;
  for (std::int64_t i = 0; i < mask.pixels(); ++i) count += mask.data[i] != 0;
  return count;
}

/// 0 where `is_void`: not object, in no band, no contour.
template <class T>
std::vector<T> without_void(std::vector<T> plane, MaskPlane is_void) {
  for (std::size_t i = 0; is_void.data != nullptr && i < plane.size(); ++i)
    if (is_void.data[i]) plane[i] = 0;
  return plane;
}

/// The counts of the pixels that are not void.
Confusion known_confusion(const Exec& exec, MaskPlane predicted, MaskPlane truth, MaskPlane is_void) {
  if (is_void.data == nullptr) return confusion(exec, predicted, truth);
  require_same_size(truth, is_void);
  const int w = truth.width_px, h = truth.height_px;
  const auto known = [&](MaskPlane mask) {
    return without_void(std::vector<std::uint8_t>(mask.data, mask.data + mask.pixels()), is_void);
  };
  const std::vector<std::uint8_t> p = known(predicted), t = known(truth);
  Confusion counts = confusion(exec, {p.data(), w, h}, {t.data(), w, h});
  counts.tn -= count_set(is_void);
  return counts;
}

/// Wrong pixels farther than band_px from the truth's contour.
void count_far_errors(MaskPlane predicted, MaskPlane truth, int band_px, MaskScores& scores) {
  const std::vector<std::int32_t> distance = signed_distance(truth);
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const bool p = predicted.data[i] != 0;
    scores.far_fp += p && -distance[i] > band_px;
    scores.far_fn += !p && distance[i] > band_px;
  }
}

}  // namespace

Confusion confusion(const Exec& exec, MaskPlane predicted, MaskPlane truth) {
  require_same_size(predicted, truth);
  std::vector<Confusion> rows(std::size_t(predicted.height_px));
  for_each_index(exec, predicted.height_px, ConfusionRow{predicted, truth, rows.data()});
  Confusion sum;
  for (const Confusion& row : rows) {
    sum.tp += row.tp;
    sum.fp += row.fp;
    sum.fn += row.fn;
    sum.tn += row.tn;
  }
  return sum;
}

double iou(const Confusion& c) { return ratio_or(c.tp, c.tp + c.fp + c.fn, 1.0); }

double pixel_accuracy(const Confusion& c) { return ratio_or(c.tp + c.tn, c.total(), 1.0); }

double class_accuracy(const Confusion& c) {
  const std::uint64_t object = c.tp + c.fn, background = c.tn + c.fp;
  if (object == 0) return ratio_or(c.tn, background, 1.0);
  if (background == 0) return ratio_or(c.tp, object, 1.0);
  return 0.5 * (double(c.tp) / double(object) + double(c.tn) / double(background));
}

std::vector<std::int32_t> chessboard_distance(MaskPlane mask, Outside outside) {
  const std::int64_t w = mask.width_px, h = mask.height_px;
  const std::int32_t beyond = outside == Outside::kComplement ? 0 : kUnbounded;
  std::vector<std::int32_t> distance(std::size_t(mask.pixels()));
  const auto at = [&](std::int64_t x, std::int64_t y) {
    return x < 0 || y < 0 || x >= w || y >= h ? beyond : distance[std::size_t(y * w + x)];
  };
  const auto step = [](std::int32_t nearest) { return nearest >= kUnbounded ? kUnbounded : nearest + 1; };
  for (std::int64_t y = 0; y < h; ++y)
    for (std::int64_t x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y * w + x);
      if (mask.data[i] == 0) continue;
      distance[i] = step(std::min(std::min(at(x - 1, y - 1), at(x, y - 1)), std::min(at(x + 1, y - 1), at(x - 1, y))));
    }
  for (std::int64_t y = h - 1; y >= 0; --y)
    for (std::int64_t x = w - 1; x >= 0; --x) {
      const std::size_t i = std::size_t(y * w + x);
      if (mask.data[i] == 0) continue;
      const std::int32_t back =
          step(std::min(std::min(at(x + 1, y + 1), at(x, y + 1)), std::min(at(x - 1, y + 1), at(x + 1, y))));
      distance[i] = std::min(distance[i], back);
    }
  return distance;
}

std::vector<std::int32_t> signed_distance(MaskPlane mask) {
  std::vector<std::uint8_t> outside(std::size_t(mask.pixels()));
  for (std::size_t p = 0; p < outside.size(); ++p) outside[p] = mask.data[p] == 0;
  std::vector<std::int32_t> distance = chessboard_distance(mask, Outside::kUnknown);
  const auto to_object = chessboard_distance({outside.data(), mask.width_px, mask.height_px}, Outside::kUnknown);
  for (std::size_t p = 0; p < distance.size(); ++p)
    if (outside[p]) distance[p] = -to_object[p];
  return distance;
}

int band_width_px(double ratio, int width_px, int height_px) {
  const double diagonal = std::sqrt(double(width_px) * width_px + double(height_px) * height_px);
  return std::max(1, int(std::nearbyint(ratio * diagonal)));
}

double boundary_iou(const Exec& exec, const std::vector<std::int32_t>& predicted_distance,
                    const std::vector<std::int32_t>& truth_distance, int width_px, int band_px) {
  NGS_CHECK(predicted_distance.size() == truth_distance.size(), "distance maps of a pair differ in size");
  if (predicted_distance.empty()) return 1.0;
  const std::int64_t rows = std::int64_t(predicted_distance.size()) / width_px;
  std::vector<std::uint64_t> common(std::size_t(rows), 0), any(std::size_t(rows), 0);
  for_each_index(
      exec, rows,
      BandRow{predicted_distance.data(), truth_distance.data(), width_px, band_px, common.data(), any.data()});
  std::uint64_t in_both = 0, in_any = 0;
  for (std::size_t y = 0; y < common.size(); ++y) {
    in_both += common[y];
    in_any += any[y];
  }
  return ratio_or(in_both, in_any, 1.0);
}

std::vector<std::int32_t> squared_distance(MaskPlane mask) {
  const int w = mask.width_px;
  const std::vector<std::int32_t> column = column_distance({mask.data, mask.data + mask.pixels()}, w, mask.height_px);
  std::vector<std::int32_t> distance2(column.size(), kUnbounded);
  std::vector<std::int64_t> owner(static_cast<std::size_t>(w)), from(static_cast<std::size_t>(w));
  for (int y = 0; y < mask.height_px; ++y) {
    const std::int32_t* dy = column.data() + std::int64_t(y) * w;
    const auto cost = [&](std::int64_t x, std::int64_t u) { return (x - u) * (x - u) + std::int64_t(dy[u]) * dy[u]; };
    // Column owner[k] is the nearest one from x = from[k] on: the lower envelope of parabolas, in integers.
    std::size_t owners = 0;
    for (std::int64_t u = 0; u < w; ++u) {
      if (dy[u] == kUnbounded) continue;
      while (owners > 0 && cost(from[owners - 1], owner[owners - 1]) > cost(from[owners - 1], u)) --owners;
      const std::int64_t last = owners > 0 ? owner[owners - 1] : 0;
      const std::int64_t start = owners > 0 ? 1 + (cost(0, u) - cost(0, last)) / (2 * (u - last)) : 0;
      if (start < w) {
        owner[owners] = u;
        from[owners++] = start;
      }
    }
    for (std::int64_t x = w - 1; x >= 0 && owners > 0; --x) {
      distance2[std::size_t(std::int64_t(y) * w + x)] = std::int32_t(cost(x, owner[owners - 1]));
      if (x == from[owners - 1]) --owners;
    }
  }
  return distance2;
}

double contour_f(MaskPlane predicted, MaskPlane truth, int tolerance_px, MaskPlane is_void) {
  require_same_size(predicted, truth);
  const int w = predicted.width_px, h = predicted.height_px;
  const std::vector<std::uint8_t> p = contour_of(predicted), t = contour_of(truth);
  const Matched precision = match(without_void(p, is_void), column_distance(t, w, h), w, tolerance_px);
  const Matched recall = match(without_void(t, is_void), column_distance(p, w, h), w, tolerance_px);
  // A mask without a contour matches no contour pixel of the other mask, so its own empty share may be 1.
  const double share_p = ratio_or(precision.matched, precision.total, 1.0);
  const double share_r = ratio_or(recall.matched, recall.total, 1.0);
  return share_p + share_r == 0 ? 0.0 : 2 * share_p * share_r / (share_p + share_r);
}

std::array<double, kScoreNames.size()> score_values(const MaskScores& s) {
  return {s.iou, s.accuracy, s.class_accuracy, s.biou, s.biou_005, s.biou_1px, s.biou_3px, s.biou_5px, s.contour_f};
}

MaskScores score_mask(const Exec& exec, MaskPlane predicted, MaskPlane truth, double contour_tolerance,
                      MaskPlane is_void) {
  MaskScores s;
  s.counts = known_confusion(exec, predicted, truth, is_void);
  s.iou = iou(s.counts);
  s.accuracy = pixel_accuracy(s.counts);
  s.class_accuracy = class_accuracy(s.counts);
  s.both_empty = s.counts.both_empty();
  s.one_empty = s.counts.one_empty();

  const int w = truth.width_px, h = truth.height_px;
  std::vector<std::uint8_t> closest;
  if (is_void.data != nullptr) {
    closest = closest_truth(predicted, truth, is_void);
    truth.data = closest.data();
    s.void_px = count_set(is_void);
  }
  const std::vector<std::int32_t> p = without_void(chessboard_distance(predicted), is_void),
                                  t = without_void(chessboard_distance(truth), is_void);
  const int wide_band_px = band_width_px(0.02, w, h);
  s.biou = boundary_iou(exec, p, t, w, wide_band_px);
  s.biou_005 = boundary_iou(exec, p, t, w, band_width_px(0.005, w, h));
  s.biou_1px = boundary_iou(exec, p, t, w, 1);
  s.biou_3px = boundary_iou(exec, p, t, w, 3);
  s.biou_5px = boundary_iou(exec, p, t, w, 5);
  const double diagonal = std::sqrt(double(w) * w + double(h) * h);
  // A full mask has no contour: one_empty must still score 0.
  s.contour_f = s.one_empty ? 0.0 : contour_f(predicted, truth, int(std::ceil(contour_tolerance * diagonal)), is_void);
  count_far_errors(predicted, truth, wide_band_px, s);
  return s;
}

double mean_squared_error(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight) {
  NGS_CHECK(a.width_px == b.width_px && a.height_px == b.height_px && a.channels == b.channels,
            "mean_squared_error: the images differ in size");
  std::vector<double> row_sum(std::size_t(a.height_px)), row_weight(std::size_t(a.height_px));
  for_each_index(exec, a.height_px, [&](std::int64_t y) {
    double sum = 0, weights = 0;
    for (int x = 0; x < a.width_px; ++x) {
      const double w = weight ? double(weight->at(x, int(y))) : 1.0;
      for (int c = 0; c < a.channels; ++c) {
        const double d = double(a.at(x, int(y), c)) - double(b.at(x, int(y), c));
        sum += w * d * d;
      }
      weights += w;
    }
    row_sum[std::size_t(y)] = sum;
    row_weight[std::size_t(y)] = weights;
  });
  double sum = 0, weights = 0;
  for (std::size_t y = 0; y < row_sum.size(); ++y) {
    sum += row_sum[y];
    weights += row_weight[y];
  }
  return sum / (weights * a.channels);
}

double psnr_db(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight) {
  return -10.0 * std::log10(mean_squared_error(exec, a, b, weight));
}

double ssim_index(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight) {
  return PhotometricPass<float>().evaluate(exec, {}, {a, b, weight}, nullptr).ssim;
}

OpacityErrors opacity_errors(const std::vector<float>& opacity, MaskPlane silhouette, MaskPlane occluders) {
  const std::vector<std::int32_t> inside = signed_distance(silhouette),
                                  occluder = occluders.data == nullptr
                                                 ? std::vector<std::int32_t>(opacity.size(), -kUnbounded)
                                                 : signed_distance(occluders);
  OpacityErrors errors;
  for (std::size_t i = 0; i < opacity.size(); ++i) {
    const double a = double(opacity[i]);
    if (!(a >= 0 && a <= 1))
      throw Error(ErrorCode::kNumeric, "opacity " + std::to_string(a) + ", expected a number in [0, 1]");
    if (-occluder[i] <= kOccluderMargin_px) continue;
    errors.contour_px += inside[i] == 1;
    for (std::size_t b = 0; b < kHaloBands_px.size(); ++b) {
      if (-inside[i] > kHaloBands_px[b]) errors.halo_px[b] += a;
      if (inside[i] > kHaloBands_px[b]) errors.holes_px[b] += 1 - a;
    }
  }
  for (auto* sums : {&errors.halo_px, &errors.holes_px})
    for (double& sum : *sums) sum = errors.contour_px > 0 ? sum / errors.contour_px : 0;
  return errors;
}

}  // namespace ngs
