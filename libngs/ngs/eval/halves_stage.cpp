#include "ngs/eval/halves_stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/math/vectors.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/scene/geometry/unproject.h"

namespace ngs {
namespace {

using V = Vec3<double>;
constexpr int kPointStep_px = 4;
constexpr double kDepthTolerance = 0.02;  // of the depth: surfaces are slanted, and depth is that of the pixel's centre
constexpr double kRadiansToDegrees = 180 / std::numbers::pi;

double finite_psnr(double psnr_db) {
  if (std::isnan(psnr_db)) throw Error(ErrorCode::kNumeric, "rendered colours: NaN, expected numbers");
  return std::min(psnr_db, kEqualPsnrDb);
}

template <class Test>
PixelMask plane_where(const ImageF& image, Test&& test) {
  PixelMask plane(image.data.size());
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = test(image.data[i]);
  return plane;
}

ImageF weight_of(const PixelMask& plane, int width_px, int height_px) {
  ImageF weight(width_px, height_px, 1);
  std::transform(plane.begin(), plane.end(), weight.data.begin(), [](std::uint8_t set) { return set ? 1.f : 0.f; });
  return weight;
}

/// The sum of squared deviations from the mean, channel by channel, and the number of views.
class Spread {
 public:
  void add(const ImageF& rendered, const ImageF& truth, std::size_t pixel) {
    ++views_;
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = double(rendered.data[3 * pixel + c]) - double(truth.data[3 * pixel + c]);
      const double delta = error - mean_[c];  // Welford
      mean_[c] += delta / views_;
      squares_ += delta * (error - mean_[c]);
    }
  }
  int views() const { return views_; }
  double deviation() const { return std::sqrt(std::max(0.0, squares_) / (3.0 * views_)); }

 private:
  int views_ = 0;
  double mean_[3] = {0, 0, 0}, squares_ = 0;
};

/// The pixel of the view that shows the world point in the hole; -1: none.
std::int64_t hole_pixel(const HoleView& view, V world) {
  const std::optional<V> q = view.camera.project(world);
  if (!q) return -1;
  const std::int64_t pixel = std::int64_t(q->y) * view.camera.width_px + std::int64_t(q->x);
  const double shown = double(view.depth.data[std::size_t(pixel)]);
  return view.hole[std::size_t(pixel)] && std::abs(q->z - shown) <= kDepthTolerance * shown ? pixel : -1;
}

V surface_point(const HoleView& view, int x, int y) {
  return unproject(view.camera, x + 0.5, y + 0.5, double(view.depth.at(x, y)));
}

/// Sum of deviations and number of points that start in this view.
struct FlickerSum {
  double deviation = 0;
  std::int64_t points = 0;
};

FlickerSum flicker_of_points(const HoleView& from, std::span<const HoleView> views) {
  FlickerSum sum;
  for (int y = 0; y < from.camera.height_px; y += kPointStep_px)
    for (int x = 0; x < from.camera.width_px; x += kPointStep_px) {
      if (!from.hole[from.depth.index(x, y)]) continue;
      const V world = surface_point(from, x, y);
      Spread spread;
      for (const HoleView& view : views)
        if (const std::int64_t pixel = hole_pixel(view, world); pixel >= 0)
          spread.add(view.rendered, view.truth, std::size_t(pixel));
      if (spread.views() >= 2) {
        sum.deviation += spread.deviation();
        ++sum.points;
      }
    }
  return sum;
}

}  // namespace

AloneScore score_alone(const Exec& exec, const RenderedView& rendered, const ImageF& colour, const ImageF& alpha) {
  NGS_CHECK(rendered.alpha.data.size() == alpha.data.size() && colour.pixels() == alpha.pixels(),
            "score_alone: the images differ in size");
  for (const float a : rendered.alpha.data)
    if (!(a >= 0.f && a <= 1.f))
      throw Error(ErrorCode::kNumeric, "opacity " + std::to_string(a) + ", expected a number in [0, 1]");
  const int w = alpha.width_px, h = alpha.height_px;
  const PixelMask touched = plane_where(alpha, [](float a) { return a > 0.f; });
  const PixelMask solid = plane_where(alpha, [](float a) { return a >= 0.5f; });
  const PixelMask found = plane_where(rendered.alpha, [](float a) { return a > 0.5f; });
  if (std::find(touched.begin(), touched.end(), 1) == touched.end())
    throw Error(ErrorCode::kBadInput, "the true picture shows no object, expected a pixel with alpha above 0");

  AloneScore score;
  const MaskScores masks = score_mask(exec, {found.data(), w, h}, {solid.data(), w, h});
  score.iou = masks.iou;
  score.biou = masks.biou;
  const std::vector<std::int32_t> outside2 = squared_distance({touched.data(), w, h});
  const PixelMask empty = plane_where(alpha, [](float a) { return !(a >= 0.5f); });
  const std::vector<std::int32_t> inside2 = squared_distance({empty.data(), w, h});
  constexpr int kSlack2 = kContourSlack_px * kContourSlack_px;
  PixelMask near(touched.size());
  std::int32_t longest2 = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    near[i] = outside2[i] <= kSlack2;
    const bool is_spike = found[i] && !near[i];
    score.spikes_px += is_spike;
    if (is_spike) longest2 = std::max(longest2, outside2[i]);
    score.holes_px += inside2[i] > kSlack2 && rendered.alpha.data[i] < 0.5f;
  }
  score.longest_spike_px = std::sqrt(double(longest2));
  const ImageF weight = weight_of(near, w, h);
  score.psnr_db = finite_psnr(psnr_db(exec, rendered.colour, colour, &weight));
  return score;
}

AloneScore mean_of(std::span<const AloneScore> scores) {
  AloneScore mean;
  const double share = scores.empty() ? 0 : 1.0 / double(scores.size());
  for (const AloneScore& s : scores) {
    mean.iou += share * s.iou;
    mean.biou += share * s.biou;
    mean.psnr_db += share * s.psnr_db;
    mean.spikes_px += share * s.spikes_px;
    mean.longest_spike_px += share * s.longest_spike_px;
    mean.holes_px += share * s.holes_px;
  }
  return mean;
}

double angle_to_nearest(Vec3<double> centre, const Camera& camera, std::span<const Camera> others) {
  double cosine = -1;
  const V own = unit(camera.centre() - centre);
  for (const Camera& other : others) cosine = std::max(cosine, dot(own, unit(other.centre() - centre)));
  return kRadiansToDegrees * std::acos(std::min(cosine, 1.0));
}

HoleScore score_hole(const Exec& exec, const HoleView& view) {
  const ImageF weight = weight_of(view.hole, view.truth.width_px, view.truth.height_px);
  return {finite_psnr(psnr_db(exec, view.rendered, view.truth, &weight)),
          ssim_index(exec, view.rendered, view.truth, &weight)};
}

Flicker flicker(const Exec& exec, std::span<const HoleView> views) {
  std::vector<FlickerSum> sums(views.size());
  for_each_task(exec, std::int64_t(views.size()),
                [&](std::int64_t i) { sums[std::size_t(i)] = flicker_of_points(views[std::size_t(i)], views); });
  FlickerSum all;
  for (const FlickerSum& sum : sums) {
    all.deviation += sum.deviation;
    all.points += sum.points;
  }
  return {all.points > 0 ? all.deviation / double(all.points) : 0, all.points};
}

OutsideChange outside_change(std::span<const HoleView> views, std::span<const ImageF> full) {
  NGS_CHECK(views.size() == full.size(), "outside_change: one full picture per view");
  OutsideChange change;
  std::int64_t samples = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const HoleView& view = views[v];
    const int w = view.truth.width_px, h = view.truth.height_px, margin_px = band_width_px(0.02, w, h);
    const std::vector<std::int32_t> distance2 = squared_distance({view.hole.data(), w, h});
    for (std::size_t i = 0; i < 3 * distance2.size(); ++i) {
      if (distance2[i / 3] <= margin_px * margin_px) continue;
      const double difference = std::abs(double(view.rendered.data[i]) - double(full[v].data[i]));
      change.mean += difference;
      change.most = std::max(change.most, difference);
      ++samples;
    }
  }
  if (samples > 0) change.mean /= double(samples);
  return change;
}

}  // namespace ngs
