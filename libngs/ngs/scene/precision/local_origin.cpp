#include "ngs/scene/precision/local_origin.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/math/median.h"

namespace ngs {

double usual_size(const GaussianCloud& cloud) {
  std::vector<double> middle;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    if (!cloud.usable[i]) continue;
    const float a = cloud.log_scale[i * 3], b = cloud.log_scale[i * 3 + 1], c = cloud.log_scale[i * 3 + 2];
    middle.push_back(double(std::max(std::min(a, b), std::min(std::max(a, b), c))));
  }
  return middle.empty() ? 0 : std::exp(upper_median(std::move(middle)));
}

double float_spacing(const GaussianCloud& cloud) {
  float farthest = 0;
  for (const double o : cloud.origin) farthest = std::max(farthest, float(std::abs(o)));
  return double(std::nextafter(farthest, std::numeric_limits<float>::infinity())) - double(farthest);
}

bool needs_local_origin(const GaussianCloud& cloud) {
  constexpr double kFinest = 1.0 / 16;  // of usual_size(): the rounding error is invisible in images
  return cloud.origin != std::array<double, 3>{} && float_spacing(cloud) > kFinest * usual_size(cloud);
}

}  // namespace ngs
