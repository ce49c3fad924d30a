#include "ngs/stages/select/needles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/math/quat.h"
#include "ngs/ops/field/knn.h"
#include "ngs/stages/select/clusters.h"

namespace ngs {
namespace {

constexpr double kNeedleReach = 2;  // standard deviations from the centre to an end
constexpr double kElongation = 3;   // longest over second longest standard deviation

/// The ends of a Gaussian along its longest axis, 6 numbers; empty if it is not long and thin.
std::vector<float> ends_of(const GaussianCloud& cloud, std::size_t i, double skin) {
  const float* s = &cloud.log_scale[3 * i];
  const auto longest = std::size_t(std::max_element(s, s + 3) - s);
  std::array<float, 3> sorted{s[0], s[1], s[2]};
  std::ranges::sort(sorted);
  const double sigma = std::exp(double(sorted[2]));
  if (!(kNeedleReach * sigma > skin) || !(double(sorted[2]) - double(sorted[1]) >= std::log(kElongation))) return {};
  const Mat3<double> axes = axes_of_quaternion(&cloud.rotation[4 * i]);
  std::vector<float> ends;
  for (const double way : {-kNeedleReach * sigma, kNeedleReach * sigma})
    for (int a = 0; a < 3; ++a)
      ends.push_back(float(double(cloud.position[3 * i + std::size_t(a)]) + way * axes(a, int(longest))));
  return ends;
}

}  // namespace

std::vector<std::uint32_t> needles_beyond(const Exec& exec, const GaussianCloud& cloud,
                                          const std::vector<std::uint8_t>& object, double skin) {
  NGS_CHECK(std::int64_t(object.size()) == cloud.size(), "one entry per Gaussian");
  std::vector<std::uint32_t> row;
  if (!(skin > 0)) return row;
  std::vector<float> ends, inside, outside;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (!cloud.usable[i]) continue;
    const std::vector<float> of_row = object[i] ? ends_of(cloud, i, skin) : std::vector<float>();
    if (!of_row.empty()) {
      row.push_back(std::uint32_t(i)), ends.insert(ends.end(), of_row.begin(), of_row.end());
    } else if (cloud.logit_opacity[i] >= kSolidLogit) {
      std::vector<float>& side = object[i] ? inside : outside;
      side.insert(side.end(), &cloud.position[3 * i], &cloud.position[3 * i] + 3);
    }
  }
  if (row.empty() || outside.empty()) return {};
  const auto near = [&](const std::vector<float>& points, const std::vector<std::uint8_t>& active) {
    return any_within(exec, {points.data(), std::int64_t(points.size() / 3)},
                      {ends.data(), std::int64_t(ends.size() / 3)}, skin, active);
  };
  std::vector<std::uint8_t> leaves = near(inside, {});
  for (std::uint8_t& end : leaves) end = !end;
  const std::vector<std::uint8_t> enters = near(outside, leaves);
  std::vector<std::uint32_t> found;
  for (std::size_t k = 0; k < row.size(); ++k)
    if (enters[2 * k] || enters[2 * k + 1]) found.push_back(row[k]);
  return found;
}

}  // namespace ngs
