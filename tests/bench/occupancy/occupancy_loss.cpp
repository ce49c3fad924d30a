#include "occupancy/occupancy_loss.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ngs/core/rng.h"
#include "ngs/math/median.h"
#include "ngs/math/quat.h"
#include "ngs/math/stable.h"

namespace ngs::bench {
namespace {

constexpr std::size_t kDensityPoints = 200;
constexpr double kReach = 3;  // standard deviations

double distance_of_kth(const std::vector<float>& points, std::size_t from, std::size_t k) {
  std::vector<double> distance2;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = double(points[i + a]) - double(points[from + a]);
      sum += d * d;
    }
    distance2.push_back(sum);
  }
  k = std::min(k, distance2.size() - 1);
  std::nth_element(distance2.begin(), distance2.begin() + std::ptrdiff_t(k), distance2.end());
  return std::sqrt(distance2[k]);
}

/// One Gaussian with its two longest axes.
struct Surfel {
  std::size_t row;
  Vec3<double> centre, axis[2];
  double sigma[2];
  std::size_t column[2];  // of the axes in the rotation

  Surfel(const GaussianCloud& cloud, std::size_t i) : row(i) {
    const float *p = &cloud.position[3 * i], *s = &cloud.log_scale[3 * i];
    const Mat3<double> axes = axes_of_quaternion(&cloud.rotation[4 * i]);
    const auto least = std::size_t(std::min_element(s, s + 3) - s);
    centre = {double(p[0]), double(p[1]), double(p[2])};
    for (std::size_t k = 0; k < 2; ++k) {
      column[k] = (least + 1 + k) % 3;
      const int c = int(column[k]);
      axis[k] = {axes(0, c), axes(1, c), axes(2, c)}, sigma[k] = std::exp(double(s[column[k]]));
    }
  }
};

struct Sums {
  double alpha = 0;  // of G Q
  Vec3<double> position{0, 0, 0};
  double log_scale[2] = {0, 0};
  Mat3<double> rotation{};
};

/// ∂/∂ of G at the fixed point centre + u σ_u axis_u + v σ_v axis_v.
void add_sample(const Surfel& g, double u, double v, Sums& sums) {
  const double weight = std::exp(-0.5 * (u * u + v * v)), at[2] = {u, v};
  const Vec3<double> d = (u * g.sigma[0]) * g.axis[0] + (v * g.sigma[1]) * g.axis[1];
  sums.alpha += weight;
  for (std::size_t k = 0; k < 2; ++k) {
    sums.position = sums.position + (weight * at[k] / g.sigma[k]) * g.axis[k];
    sums.log_scale[k] += weight * at[k] * at[k];
    const double turn = -weight * at[k] / g.sigma[k];
    const int c = int(g.column[k]);
    sums.rotation(0, c) += turn * d.x, sums.rotation(1, c) += turn * d.y, sums.rotation(2, c) += turn * d.z;
  }
}

void add_row(const GaussianCloud& cloud, const Surfel& g, const Sums& sums, double weight, CloudGradients& out) {
  const std::size_t i = g.row;
  const double alpha = sigmoid(double(cloud.logit_opacity[i]));
  out.logit_opacity[i] += float(weight * alpha * (1 - alpha) * sums.alpha);
  const double position[3] = {sums.position.x, sums.position.y, sums.position.z};
  for (std::size_t a = 0; a < 3; ++a) out.position[3 * i + a] += float(weight * alpha * position[a]);
  for (std::size_t k = 0; k < 2; ++k) out.log_scale[3 * i + g.column[k]] += float(weight * alpha * sums.log_scale[k]);
  const float* q = &cloud.rotation[4 * i];
  double inv_norm = 0;
  const Vec4<double> unit = normalised(Vec4<double>{double(q[0]), double(q[1]), double(q[2]), double(q[3])}, inv_norm);
  const Vec4<double> back = normalised_backward(unit, inv_norm, rotation_matrix_backward(unit, sums.rotation));
  const double turned[4] = {back.x, back.y, back.z, back.w};
  for (std::size_t a = 0; a < 4; ++a) out.rotation[4 * i + a] += float(weight * alpha * turned[a]);
}

}  // namespace

Voxels::Voxels(const std::vector<float>& points, int k, std::uint64_t seed) {
  const std::size_t count = points.size() / 3;
  if (count < 2) return;
  std::vector<double> distance;
  for (std::uint64_t n = 0; n < kDensityPoints; ++n) {
    const auto at = std::min(count - 1, std::size_t(rng_uniform(seed, RngStream::kTest, n) * double(count)));
    distance.push_back(distance_of_kth(points, 3 * at, std::size_t(k)));
  }
  side_ = std::cbrt(4.0 / 3 * std::numbers::pi) * upper_median(std::move(distance));
  if (!(side_ > 0)) return;
  grid_ = CellGrid({0, 0, 0}, side_);
  std::unordered_set<std::uint64_t> occupied;
  for (std::size_t i = 0; i < points.size(); i += 3) occupied.insert(grid_.of(&points[i]));
  for (const std::uint64_t cell : occupied)
    CellGrid::for_neighbours(cell, [&](std::uint64_t near) { near_.insert(near); });
}

double add_occupancy_gradient(const ClassedModel& model, const OccupancySamples& samples, double weight,
                              CloudGradients& gradients) {
  const GaussianCloud& cloud = model.cloud;
  const std::vector<std::uint8_t>& object = model.object;
  const double share = 1.0 / (double(cloud.size()) * samples.per_gaussian);
  double loss = 0;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (!cloud.usable[i]) continue;
    const Surfel g(cloud, i);
    Sums sums;
    for (int r = 0; r < samples.per_gaussian; ++r) {
      const std::uint64_t draw =
          2 * ((samples.step * object.size() + i) * std::uint64_t(samples.per_gaussian) + std::uint64_t(r));
      const double u = kReach * (2 * rng_uniform(samples.seed, RngStream::kSplit, draw) - 1);
      const double v = kReach * (2 * rng_uniform(samples.seed, RngStream::kSplit, draw + 1) - 1);
      const Vec3<double> p = g.centre + (u * g.sigma[0]) * g.axis[0] + (v * g.sigma[1]) * g.axis[1];
      const float at[3] = {float(p.x), float(p.y), float(p.z)};
      if (!model.voxels[object[i]].supports(at)) add_sample(g, u, v, sums);
    }
    if (sums.alpha == 0) continue;
    add_row(cloud, g, sums, weight * share, gradients);
    loss += share * sigmoid(double(cloud.logit_opacity[i])) * sums.alpha;
  }
  return loss;
}

double boundary_gradient(const RenderedView& rendered, const std::vector<std::uint8_t>& mask, double weight,
                         ViewGradients& gradients) {
  gradients.label = rendered.label, gradients.alpha = rendered.alpha;
  gradients.label_moves_geometry = true;
  const auto share = float(weight / double(mask.size()));
  double loss = 0;
  for (std::size_t p = 0; p < mask.size(); ++p) {
    const float object = rendered.label.data[p], rest = rendered.alpha.data[p] - object;
    loss += double(mask[p] ? rest : object) / double(mask.size());
    gradients.label.data[p] = mask[p] ? -share : share, gradients.alpha.data[p] = mask[p] ? share : 0.f;
  }
  return loss;
}

}  // namespace ngs::bench
