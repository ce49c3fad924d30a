#include "ngs/stages/scene/view_shares.h"

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
    const float* p = &cloud.position[std::size_t(i) * 3];
    const Vec3<double> world{cloud.origin[0] + double(p[0]), cloud.origin[1] + double(p[1]),
                             cloud.origin[2] + double(p[2])};
    const Vec3<double> t = camera.rotation * world + camera.translation;
    if (!(t.z > 0)) continue;
    ++in_front;
    const double x = camera.fx * t.x / t.z + camera.cx, y = camera.fy * t.y / t.z + camera.cy;
    inside += x >= 0 && x < camera.width_px && y >= 0 && y < camera.height_px;
  }
  return {double(in_front) / double(sample.size()), double(inside) / double(sample.size())};
}

}  // namespace ngs
