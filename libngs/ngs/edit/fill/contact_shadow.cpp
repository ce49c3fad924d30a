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

constexpr double kReach = 0.1, kReachCells = 3;  // of the ring: diagonals, and at least so many cells
constexpr double kFaint = 0.3;                   // opacity
constexpr std::size_t kMinRing = 8, kMinAround = 30, kMinStep = 4;  // cells
constexpr double kDarker = 0.1;      // least logarithm of the darkening in the inner part of the ring
constexpr double kMostDarker = 0.8;  // fraction of its cells
constexpr double kInner = 0.6;       // of the reach
constexpr double kLeast = 0.2;       // factor

double level(const TextureGrid& texture, std::size_t cell) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) sum += std::max(0.0, 0.5 + kShC0 * double(texture.colour[3 * cell + a]));
  return std::log(std::max(sum / 3, 0.02));
}

}  // namespace

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
  TextureGrid around = texture;  // the ring is continued from the cells around it
  std::vector<std::size_t> ring;
  std::size_t known = 0;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (around.state[i] == Texel::kUnknown) around.state[i] = Texel::kNone;
    if (around.state[i] != Texel::kKnown) continue;
    if (distance[i] < reach) {
      around.state[i] = Texel::kUnknown;
      ring.push_back(i);
    } else {
      ++known;
    }
  }
  if (ring.size() < kMinRing || known < kMinAround) return {};
  fill_by_repeats(exec, around);
  std::vector<std::vector<double>> ratios(std::size_t(reach / side) + 1);
  std::vector<double> inner;
  for (const std::size_t i : ring) {
    if (around.state[i] != Texel::kKnown) continue;
    const double ratio = level(texture, i) - level(around, i);
    ratios[std::size_t(distance[i] / side)].push_back(ratio);
    if (distance[i] < kInner * reach) inner.push_back(ratio);
  }
  const auto darker = std::size_t(std::ranges::count_if(inner, [](double r) { return r < 0; }));
  if (inner.size() < kMinStep || double(darker) < kMostDarker * double(inner.size()) ||
      upper_median(std::move(inner)) > -kDarker)
    return {};
  ContactShadow shadow{side, std::vector<double>(ratios.size(), 1)};
  double left = 1;
  for (std::size_t k = ratios.size(); k-- > 0;) {
    if (ratios[k].size() >= kMinStep) left = std::min(left, std::exp(upper_median(std::move(ratios[k]))));
    shadow.left[k] = std::max(left, kLeast);
  }
  return shadow;
}

}  // namespace ngs
