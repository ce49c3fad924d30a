#include "ngs/capture/view_shares.h"

#include <algorithm>

namespace ngs {

std::vector<std::int64_t> sample_usable(const GaussianCloud& cloud) {
  constexpr std::int64_t kMaxSampled = 1 << 18;
  const std::int64_t stride = (cloud.size() + kMaxSampled - 1) / kMaxSampled;
  std::vector<std::int64_t> sample;
  for (std::int64_t i = 0; i < cloud.size(); i += stride)
    if (cloud.usable[std::size_t(i)] != 0) sample.push_back(i);
  return sample;
}

ViewShares view_shares(const GaussianCloud& cloud, const Camera& camera, const std::vector<std::int64_t>& sample) {
  std::int64_t in_front = 0, inside = 0;
  for (const std::int64_t i : sample) {
    const Vec3<double> world = world_position(cloud, std::size_t(i));
    in_front += camera.to_camera(world).z > 0;
    inside += camera.project(world).has_value();
  }
  return {double(in_front) / double(sample.size()), double(inside) / double(sample.size())};
}

std::vector<std::size_t> evenly_spaced(std::size_t count, std::size_t n) {
  std::vector<std::size_t> out;
  count = std::min(count, n);
  for (std::size_t i = 0; i < count; ++i) out.push_back((2 * i + 1) * n / (2 * count));
  return out;
}

}  // namespace ngs
