#include "ngs/stages/orbit/coverage.h"

#include <algorithm>

#include "ngs/math/stable.h"
#include "ngs/ops/splat/evidence.h"

namespace ngs::orbit {
namespace {

constexpr double kShows = 0.25, kOnSurface = 0.5;

/// Mean weight of a Gaussian with nothing before it over the pixels that it reaches: o exp(-r²/2) down to 1/255, over
/// the area of that ellipse.
double unhidden_weight(double opacity) {
  const double cut = 1.0 / 255;
  return opacity > 1.01 * cut ? (opacity - cut) / std::log(opacity / cut) : cut;
}

}  // namespace

Sights::Sights(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::int32_t>& point_of_row)
    : cloud_(cloud), point_of_row_(point_of_row) {
  splat_.compat = Compat::kGsplat;  // the nearer near plane
  splat_.max_sh_degree = 0;
  splat_.prepared = prepare_cloud(exec, cloud);
}

Sight Sights::of(const Exec& exec, const Camera& camera, double nearer_than) const {
  ViewMasks whole;
  whole.width_px = camera.width_px, whole.height_px = camera.height_px, whole.available = true;
  const ViewSums sums = view_sums(exec, cloud_, {camera, whole}, splat_);
  const Camera relative = relative_to(camera, cloud_.origin);
  Sight sight;
  double total = 0, before = 0;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const std::uint32_t row = sums.row[v];
    const double weight = sums.at(v)[0], pixels = sums.at(v)[1];
    total += weight;
    const std::int32_t point = point_of_row_[row];
    if (point < 0) {
      const float* p = &cloud_.position[3 * std::size_t(row)];
      const double z = (relative.rotation * Vec{p[0], p[1], p[2]} + relative.translation).z;
      before += z < nearer_than ? weight : 0;
      continue;
    }
    const double passed = weight / (pixels * unhidden_weight(sigmoid(double(cloud_.logit_opacity[row]))));
    if (passed >= kShows) sight.shown.push_back(std::uint32_t(point));
    if (passed >= kOnSurface) sight.surface.push_back(std::uint32_t(point));
  }
  sight.blocked = total > 0 ? before / total : 0;
  return sight;
}

Coverage::Coverage(std::vector<double> worth, const std::vector<Sight>& pool) : views_(worth.size(), 0) {
  std::vector<std::uint8_t> on_surface(worth.size(), 0);
  for (const Sight& sight : pool)
    for (const std::uint32_t point : sight.surface) on_surface[point] = 1;
  worth_ = std::move(worth);
  for (std::size_t i = 0; i < worth_.size(); ++i) {
    if (!on_surface[i]) worth_[i] = 0;
    visible_ += worth_[i];
  }
}

void Coverage::add(const Sight& sight) {
  for (const std::uint32_t point : sight.shown)
    views_[point] = std::uint8_t(std::min<int>(views_[point] + 1, kWantedViews));
}

double Coverage::gain(const Sight& sight) const {
  double gain = 0;
  for (const std::uint32_t point : sight.shown)
    if (views_[point] < kWantedViews) gain += worth_[point];
  return gain;
}

std::size_t Coverage::gaussians() const {
  return std::size_t(std::ranges::count_if(worth_, [](double worth) { return worth > 0; }));
}

double Coverage::share() const {
  if (!(visible_ > 0)) return 1;
  double covered = 0;
  for (std::size_t i = 0; i < worth_.size(); ++i)
    if (views_[i] >= kWantedViews) covered += worth_[i];
  return covered / visible_;
}

}  // namespace ngs::orbit
