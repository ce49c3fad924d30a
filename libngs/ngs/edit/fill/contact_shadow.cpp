#include "ngs/edit/fill/contact_shadow.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/edit/fill/texture_repeats.h"
#include "ngs/math/median.h"
#include "ngs/math/sh.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr double kReach = 0.1, kReachCells = 3;  // width of the ring: in diagonals, but at least this many cells
constexpr double kFaint = 0.3;                   // Gaussians of the object with a lower opacity are ignored
constexpr std::size_t kMinRing = 8, kMinAround = 30, kMinStep = 4;  // cells
constexpr double kDarker = 0.1;      // minimum median drop of log brightness in the inner part of the ring
constexpr double kMostDarker = 0.8;  // minimum share of the inner cells that are darker than predicted
constexpr double kInner = 0.6;       // width of the inner part, as a share of the ring
constexpr double kLeast = 0.2;       // lower bound on the factor

double level_of(const float* sh_dc) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) sum += std::max(0.0, colour_of_dc(double(sh_dc[a])));
  return std::log(std::max(sum / 3, 0.02));
}

}  // namespace

double ContactShadow::at(std::int64_t cell, const float* sh_dc) const {
  if (shadow_factor.empty() || cell < 0 || shadow_factor[std::size_t(cell)] >= 1) return 1;
  const double lacks = std::exp(std::min(0.0, level_of(sh_dc) - double(level[std::size_t(cell)])));
  return std::max(lacks, double(shadow_factor[std::size_t(cell)]));
}

std::vector<double> distance_to_object(const Exec& exec, const Rim& rim, const std::vector<Vec>& points) {
  std::vector<float> object, queries;
  const auto append = [&](Vec p, std::vector<float>& to) {
    for (const double x : {p.x - rim.box.low.x, p.y - rim.box.low.y, p.z - rim.box.low.z}) to.push_back(float(x));
  };
  for (std::size_t i = 0; i < rim.object.count(); ++i)
    if (rim.object.opacity[i] >= kFaint) append(rim.object.position[i], object);
  for (const Vec& p : points) append(p, queries);
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  if (object.empty() || points.empty()) return distance;
  const KnnGraph graph = nearest_points(exec, {object.data(), std::int64_t(object.size() / 3)},
                                        {queries.data(), std::int64_t(points.size())}, 1);
  for (std::size_t i = 0; i < points.size(); ++i) distance[i] = std::sqrt(double(graph.dist2[i]));
  return distance;
}

ContactShadow find_contact_shadow(const Exec& exec, const TextureGrid& texture, const std::vector<double>& distance,
                                  double side, double diagonal) {
  const double reach = std::max(kReach * diagonal, kReachCells * side);
  TextureGrid around = texture;  // colours in the ring are predicted from the cells around it
  std::vector<std::size_t> ring;
  std::vector<double> levels;  // around it
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (around.state[i] == Texel::kUnknown) around.state[i] = Texel::kNone;
    if (around.state[i] != Texel::kKnown) continue;
    if (distance[i] < reach) {
      around.state[i] = Texel::kUnknown;
      ring.push_back(i);
    } else {
      levels.push_back(level_of(&texture.colour[3 * i]));
    }
  }
  if (ring.size() < kMinRing || levels.size() < kMinAround) return {};
  const Repeats repeats = find_repeats(exec, around);
  std::vector<std::vector<double>> darkness(std::size_t(reach / side) + 1);  // by distance in cells
  std::vector<double> inner;
  for (const std::size_t i : ring) {
    if (!(repeats.likeness[i] > 0)) continue;
    const double d = level_of(&texture.colour[3 * i]) - level_of(&repeats.colour[3 * i]);
    darkness[std::size_t(distance[i] / side)].push_back(d);
    if (distance[i] < kInner * reach) inner.push_back(d);
  }
  const auto darker = std::size_t(std::ranges::count_if(inner, [](double d) { return d < 0; }));
  if (inner.size() < kMinStep || double(darker) < kMostDarker * double(inner.size()) ||
      upper_median(std::move(inner)) > -kDarker)
    return {};
  std::vector<double> shadow_factor(darkness.size());
  double least = 1;
  for (std::size_t k = shadow_factor.size(); k-- > 0;) {
    if (darkness[k].size() >= kMinStep) least = std::min(least, std::exp(upper_median(std::move(darkness[k]))));
    shadow_factor[k] = std::max(least, kLeast);
  }
  const auto usual = float(upper_median(std::move(levels)));
  ContactShadow shadow{std::vector<float>(distance.size(), 1), std::vector<float>(distance.size(), usual)};
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (distance[i] < reach) shadow.shadow_factor[i] = float(shadow_factor[std::size_t(distance[i] / side)]);
    if (repeats.likeness[i] > 0) shadow.level[i] = float(level_of(&repeats.colour[3 * i]));
  }
  return shadow;
}

}  // namespace ngs
