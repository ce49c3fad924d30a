#include "ngs/orbit/coverage.h"

#include <algorithm>

#include "ngs/math/stable.h"
#include "ngs/ops/splat/evidence.h"

namespace ngs::orbit {
namespace {

constexpr double kShows = 0.25, kOnSurface = 0.5;

/// Mean weight of an unoccluded Gaussian over its pixels: o exp(-r²/2) down to 1/255, over the area of that ellipse.
double unoccluded_weight(double opacity) {
  const double cut = 1.0 / 255;
  return opacity > 1.01 * cut ? (opacity - cut) / std::log(opacity / cut) : cut;
}

}  // namespace

PointVisibility::PointVisibility(const Exec& exec, const GaussianCloud& cloud,
                                 const std::vector<std::int32_t>& point_of_row, double world_unit)
    : cloud_(cloud), point_of_row_(point_of_row) {
  splat_.compat = Compat::kGsplat;  // for its nearer near plane
  splat_.max_sh_degree = 0;
  splat_.world_unit = world_unit;
  splat_.prepared = prepare_cloud(exec, cloud);
}

Visibility PointVisibility::of(const Exec& exec, const Camera& camera, double nearer_than) const {
  const ViewSums sums = view_sums(exec, cloud_, {camera, known_view(camera)}, splat_);
  const Camera relative = relative_to(camera, cloud_.origin);
  Visibility visibility;
  double total = 0, before = 0;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const std::uint32_t row = sums.row[v];
    const double weight = sums.at(v)[0], pixels = sums.at(v)[1];
    total += weight;
    const std::int32_t point = point_of_row_[row];
    if (point < 0) {
      const float* p = &cloud_.position[3 * std::size_t(row)];
      const double z = relative.to_camera(Vec{p[0], p[1], p[2]}).z;
      before += z < nearer_than ? weight : 0;
      continue;
    }
    const double passed = weight / (pixels * unoccluded_weight(sigmoid(double(cloud_.logit_opacity[row]))));
    if (passed >= kShows) visibility.shown.push_back(std::uint32_t(point));
    if (passed >= kOnSurface) visibility.surface.push_back(std::uint32_t(point));
  }
  visibility.blocked = total > 0 ? before / total : 0;
  return visibility;
}

Coverage::Coverage(std::vector<double> weight, const std::vector<Visibility>& pool) : views_(weight.size(), 0) {
  std::vector<std::uint8_t> on_surface(weight.size(), 0);
  for (const Visibility& visibility : pool)
    for (const std::uint32_t point : visibility.surface) on_surface[point] = 1;
  weight_ = std::move(weight);
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    if (!on_surface[i]) weight_[i] = 0;
    visible_ += weight_[i];
  }
}

void Coverage::add(const Visibility& visibility) {
  for (const std::uint32_t point : visibility.shown)
    views_[point] = std::uint8_t(std::min<int>(views_[point] + 1, kWantedViews));
}

double Coverage::gain(const Visibility& visibility) const {
  double gain = 0;
  for (const std::uint32_t point : visibility.shown)
    if (views_[point] < kWantedViews) gain += weight_[point];
  return gain;
}

std::size_t Coverage::gaussians() const {
  return std::size_t(std::ranges::count_if(weight_, [](double weight) { return weight > 0; }));
}

double Coverage::share() const {
  if (!(visible_ > 0)) return 1;
  double covered = 0;
  for (std::size_t i = 0; i < weight_.size(); ++i)
    if (views_[i] >= kWantedViews) covered += weight_[i];
  return covered / visible_;
}

}  // namespace ngs::orbit
