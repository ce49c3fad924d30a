#include "ngs/ops/image/colour_mixture_web.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/check.h"

namespace ngs {
namespace {

constexpr int kRounds = 10, kTrials = 3;
constexpr double kLeastDeterminant = 1e-6, kAddedVariance = 0.01;  // for colours in a plane

using Centre = std::array<float, 3>;
using Centres = std::array<Centre, kMixtureComponents>;

Centre as_centre(const Rgb& colour) { return {float(colour[0]), float(colour[1]), float(colour[2])}; }

float distance2(const Rgb& colour, const Centre& centre) {
  float sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float difference = float(colour[c]) - centre[c];
    sum += difference * difference;
  }
  return sum;
}

/// The first colour at which the running sum of the distances exceeds a part of their sum.
std::size_t drawn(std::span<const float> distances, double part) {
  std::size_t i = 0;
  for (; i + 1 < distances.size(); ++i) {
    part -= double(distances[i]);
    if (part <= 0) break;
  }
  return i;
}

/// Colours as first centres: each the best of a few drawn by squared distance to the ones before.
Centres first_centres(std::span<const Rgb> colours, ClusterRandom& random) {
  Centres centres;
  centres[0] = as_centre(colours[random.next() % colours.size()]);
  std::vector<float> nearest(colours.size()), tried(colours.size()), best(colours.size());
  double sum = 0;
  for (std::size_t i = 0; i < colours.size(); ++i) sum += double(nearest[i] = distance2(colours[i], centres[0]));
  for (std::size_t k = 1; k < centres.size(); ++k) {
    double least = std::numeric_limits<double>::max();
    for (int trial = 0; trial < kTrials; ++trial) {
      const Centre candidate = as_centre(colours[drawn(nearest, random.unit() * sum)]);
      double all = 0;
      for (std::size_t i = 0; i < colours.size(); ++i)
        all += double(tried[i] = std::min(distance2(colours[i], candidate), nearest[i]));
      if (all >= least) continue;
      least = all;
      centres[k] = candidate;
      best.swap(tried);
    }
    sum = least;
    nearest.swap(best);
  }
  return centres;
}

struct Clusters {
  std::span<const Rgb> colours;
  std::vector<std::uint8_t> cluster;
  Centres centre{};
  std::array<int, kMixtureComponents> count{};

  void assign();
  /// Means of the clusters; the largest squared step of a centre.
  double move_centres();

 private:
  void fill_empty(std::size_t empty);
};

void Clusters::assign() {
  for (std::size_t i = 0; i < colours.size(); ++i) {
    float least = std::numeric_limits<float>::max();
    for (std::size_t k = 0; k < centre.size(); ++k)
      if (const float distance = distance2(colours[i], centre[k]); distance < least) {
        least = distance;
        cluster[i] = std::uint8_t(k);
      }
  }
}

/// Takes the last of the colours farthest from the mean of the largest cluster. Centres are sums here.
void Clusters::fill_empty(std::size_t empty) {
  const std::size_t largest = std::size_t(std::max_element(count.begin(), count.end()) - count.begin());
  const float scale = 1.f / float(count[largest]);
  Centre mean = centre[largest];
  for (float& x : mean) x *= scale;
  float most = 0;
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (cluster[i] != largest) continue;
    const float distance = distance2(colours[i], mean);
    if (distance < most) continue;
    most = distance;
    farthest = i;
  }
  --count[largest];
  ++count[empty];
  cluster[farthest] = std::uint8_t(empty);
  for (std::size_t c = 0; c < 3; ++c) {
    centre[largest][c] -= float(colours[farthest][c]);
    centre[empty][c] += float(colours[farthest][c]);
  }
}

double Clusters::move_centres() {
  const Centres before = centre;
  centre = {};
  count = {};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) centre[cluster[i]][c] += float(colours[i][c]);
    ++count[cluster[i]];
  }
  for (std::size_t k = 0; k < count.size(); ++k)
    if (count[k] == 0) fill_empty(k);
  double largest = 0;
  for (std::size_t k = 0; k < count.size(); ++k) {
    const float scale = 1.f / float(count[k]);
    double step2 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      centre[k][c] *= scale;
      const double step = double(centre[k][c] - before[k][c]);
      step2 += step * step;
    }
    largest = std::max(largest, step2);
  }
  return largest;
}

}  // namespace

std::uint32_t ClusterRandom::next() {
  state_ = std::uint64_t(std::uint32_t(state_)) * 4164903690u + (state_ >> 32);
  return std::uint32_t(state_);
}

double ClusterRandom::unit() {
  const std::uint64_t high = next();
  return double(high << 32 | next()) * 0x1p-64;
}

std::vector<std::uint8_t> colour_clusters(std::span<const Rgb> colours, ClusterRandom& random) {
  NGS_CHECK(colours.size() >= kMixtureComponents, "a colour for each component");
  constexpr double kStill = double(std::numeric_limits<float>::epsilon()) * std::numeric_limits<float>::epsilon();
  Clusters clusters{colours, std::vector<std::uint8_t>(colours.size()), first_centres(colours, random)};
  for (int round = 1; round < kRounds; ++round) {
    clusters.assign();
    if (clusters.move_centres() <= kStill) break;
  }
  return std::move(clusters.cluster);
}

void ColourMixture::Component::invert() {
  const auto& c = covariance;
  const auto determinant_now = [&c] {
    return c[0] * (c[4] * c[8] - c[5] * c[7]) - c[1] * (c[3] * c[8] - c[5] * c[6]) + c[2] * (c[3] * c[7] - c[4] * c[6]);
  };
  determinant = determinant_now();
  if (determinant <= kLeastDeterminant) {
    for (const std::size_t diagonal : {0, 4, 8}) covariance[diagonal] += kAddedVariance;
    determinant = determinant_now();
  }
  const double scale = 1 / determinant;
  inverse = {
      (c[4] * c[8] - c[5] * c[7]) * scale,  -(c[1] * c[8] - c[2] * c[7]) * scale, (c[1] * c[5] - c[2] * c[4]) * scale,
      -(c[3] * c[8] - c[5] * c[6]) * scale, (c[0] * c[8] - c[2] * c[6]) * scale,  -(c[0] * c[5] - c[2] * c[3]) * scale,
      (c[3] * c[7] - c[4] * c[6]) * scale,  -(c[0] * c[7] - c[1] * c[6]) * scale, (c[0] * c[4] - c[1] * c[3]) * scale};
}

double ColourMixture::Component::density(const Rgb& colour) const {
  if (weight <= 0) return 0;
  const double d[3] = {double(colour[0]) - mean[0], double(colour[1]) - mean[1], double(colour[2]) - mean[2]};
  const auto column = [&](std::size_t j) { return d[0] * inverse[j] + d[1] * inverse[3 + j] + d[2] * inverse[6 + j]; };
  const double distance = d[0] * column(0) + d[1] * column(1) + d[2] * column(2);
  return 1 / std::sqrt(determinant) * std::exp(-0.5 * distance);
}

/// Sums of 8-bit colours and of their products are exact.
void ColourMixture::learn(std::span<const Rgb> colours, std::span<const std::uint8_t> component) {
  struct Sums {
    std::array<double, 3> colour{};
    std::array<double, 9> product{};
    std::int64_t count = 0;
  };
  std::array<Sums, kMixtureComponents> sums;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    Sums& sum = sums[component[i]];
    for (std::size_t p = 0; p < 3; ++p) {
      sum.colour[p] += colours[i][p];
      for (std::size_t q = 0; q < 3; ++q) sum.product[3 * p + q] += double(colours[i][p]) * colours[i][q];
    }
    ++sum.count;
  }
  for (std::size_t k = 0; k < kMixtureComponents; ++k) {
    Component& to = components_[k];
    to = {};
    if (sums[k].count == 0) continue;
    const double scale = 1.0 / double(sums[k].count);
    to.weight = double(sums[k].count) / double(colours.size());
    for (std::size_t p = 0; p < 3; ++p) to.mean[p] = sums[k].colour[p] * scale;
    for (std::size_t p = 0; p < 3; ++p)
      for (std::size_t q = 0; q < 3; ++q)
        to.covariance[3 * p + q] = sums[k].product[3 * p + q] * scale - to.mean[p] * to.mean[q];
    to.invert();
  }
}

double ColourMixture::density(const Rgb& colour) const {
  double sum = 0;
  for (const Component& component : components_) sum += component.weight * component.density(colour);
  return sum;
}

std::uint8_t ColourMixture::component_of(const Rgb& colour) const {
  std::uint8_t best = 0;
  double most = 0;
  for (std::size_t k = 0; k < kMixtureComponents; ++k)
    if (const double density = components_[k].density(colour); density > most) {
      most = density;
      best = std::uint8_t(k);
    }
  return best;
}

}  // namespace ngs
