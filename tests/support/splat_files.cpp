#include "support/splat_files.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"

namespace ngs::test {
namespace {

double most_apart(const std::vector<float>& a, const std::vector<float>& b) {
  NGS_CHECK(a.size() == b.size(), "models of one size and SH degree");
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(double(a[i]) - double(b[i])));
  return most;
}

double probability(float logit) { return 1 / (1 + std::exp(-double(logit))); }

double quaternion_distance(const float* a, const float* b) {
  double aa = 0, bb = 0, ab = 0, most = 0;
  for (int k = 0; k < 4; ++k) aa += double(a[k]) * a[k], bb += double(b[k]) * b[k], ab += double(a[k]) * b[k];
  for (int k = 0; k < 4; ++k)
    most = std::max(most, std::abs(a[k] / std::sqrt(aa) - (ab < 0 ? -1 : 1) * b[k] / std::sqrt(bb)));
  return most;
}

}  // namespace

SplatError splat_error(const GaussianCloud& a, const GaussianCloud& b) {
  SplatError error;
  error.position = most_apart(a.position, b.position);
  error.sh_dc = most_apart(a.sh_dc, b.sh_dc);
  error.sh_rest = most_apart(a.sh_rest, b.sh_rest);
  error.log_scale = most_apart(a.log_scale, b.log_scale);
  for (std::size_t i = 0; i < a.logit_opacity.size(); ++i) {
    error.opacity =
        std::max(error.opacity, std::abs(probability(a.logit_opacity[i]) - probability(b.logit_opacity[i])));
    error.rotation = std::max(error.rotation, quaternion_distance(&a.rotation[i * 4], &b.rotation[i * 4]));
  }
  return error;
}

}  // namespace ngs::test
