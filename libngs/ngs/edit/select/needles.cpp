#include "ngs/edit/select/needles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/edit/select/clusters.h"
#include "ngs/math/quat.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

constexpr double kNeedleReach = 2;  // standard deviations from the centre to an end
constexpr double kElongation = 3;   // longest over second longest standard deviation
constexpr int kSpacingNeighbours = 4;
constexpr double kSpacings = 2;  // reach of the object beyond its Gaussians, where they are sparse

/// The ends of a Gaussian along its longest axis, 6 numbers; empty if it is not long and thin.
std::vector<float> ends_of(const GaussianCloud& cloud, std::size_t i, double margin) {
  const float* s = &cloud.log_scale[3 * i];
  const auto longest = std::size_t(std::max_element(s, s + 3) - s);
  std::array<float, 3> sorted{s[0], s[1], s[2]};
  std::ranges::sort(sorted);
  const double sigma = std::exp(double(sorted[2]));
  if (!(kNeedleReach * sigma > margin) || !(double(sorted[2]) - double(sorted[1]) >= std::log(kElongation))) return {};
  const Mat3<double> axes = axes_of_quaternion(&cloud.rotation[4 * i]);
  std::vector<float> ends;
  for (const double way : {-kNeedleReach * sigma, kNeedleReach * sigma})
    for (int a = 0; a < 3; ++a)
      ends.push_back(float(double(cloud.position[3 * i + std::size_t(a)]) + way * axes(a, int(longest))));
  return ends;
}

Rows<const float, 3> as_rows(const std::vector<float>& points) {
  return {points.data(), std::int64_t(points.size() / 3)};
}

/// Clears leaves[k] where the object is sparse: if point k is within kSpacings local spacings of the nearest Gaussian
/// of `inside`. The local spacing is the distance of that Gaussian to its fourth neighbour.
void keep_in_sparse_parts(const Exec& exec, const std::vector<float>& inside, const std::vector<float>& point,
                          std::vector<std::uint8_t>& leaves) {
  if (inside.size() / 3 <= kSpacingNeighbours) return;
  std::vector<std::size_t> index;
  std::vector<float> query, nearest;
  for (std::size_t k = 0; k < leaves.size(); ++k)
    if (leaves[k]) {
      index.push_back(k);
      query.insert(query.end(), &point[3 * k], &point[3 * k] + 3);
    }
  if (index.empty()) return;
  const KnnGraph to_object = nearest_points(exec, as_rows(inside), as_rows(query), 1);
  for (const auto j : to_object.index) nearest.insert(nearest.end(), &inside[3 * j], &inside[3 * j] + 3);
  const KnnGraph around = nearest_points(exec, as_rows(inside), as_rows(nearest), kSpacingNeighbours + 1);
  for (std::size_t q = 0; q < index.size(); ++q) {
    const double spacing = std::sqrt(double(around.dist2[(q + 1) * (kSpacingNeighbours + 1) - 1]));
    leaves[index[q]] = std::sqrt(double(to_object.dist2[q])) > kSpacings * spacing;
  }
}

}  // namespace

std::vector<std::uint32_t> needles_beyond(const Exec& exec, const GaussianCloud& cloud,
                                          const std::vector<std::uint8_t>& object, double margin) {
  NGS_CHECK(std::int64_t(object.size()) == cloud.size(), "one entry per Gaussian");
  std::vector<std::uint32_t> row;
  if (!(margin > 0)) return row;
  std::vector<float> ends, inside, outside;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (!cloud.usable[i]) continue;
    const std::vector<float> of_row = object[i] ? ends_of(cloud, i, margin) : std::vector<float>();
    if (!of_row.empty()) {
      row.push_back(std::uint32_t(i));
      ends.insert(ends.end(), of_row.begin(), of_row.end());
    } else if (cloud.logit_opacity[i] >= kSolidLogit) {
      std::vector<float>& side = object[i] ? inside : outside;
      side.insert(side.end(), &cloud.position[3 * i], &cloud.position[3 * i] + 3);
    }
  }
  if (row.empty() || outside.empty()) return {};
  const auto near = [&](const std::vector<float>& points, const std::vector<std::uint8_t>& active) {
    return any_within(exec, as_rows(points), as_rows(ends), margin, active);
  };
  std::vector<std::uint8_t> leaves = near(inside, {});
  for (std::uint8_t& end : leaves) end = !end;
  keep_in_sparse_parts(exec, inside, ends, leaves);
  const std::vector<std::uint8_t> enters = near(outside, leaves);
  std::vector<std::uint32_t> found;
  for (std::size_t k = 0; k < row.size(); ++k)
    if (enters[2 * k] || enters[2 * k + 1]) found.push_back(row[k]);
  return found;
}

}  // namespace ngs
