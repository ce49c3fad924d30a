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
  for (int k = 0; k < 4; ++k) {
    aa += double(a[k]) * a[k];
    bb += double(b[k]) * b[k];
    ab += double(a[k]) * b[k];
  }
  for (int k = 0; k < 4; ++k)
    most = std::max(most, std::abs(a[k] / std::sqrt(aa) - (ab < 0 ? -1 : 1) * b[k] / std::sqrt(bb)));
  return most;
}

}  // namespace

GaussianCloud in_order_of(const GaussianCloud& reference, const GaussianCloud& cloud) {
  NGS_CHECK(reference.size() == cloud.size(), "models of one size");
  GaussianCloud ordered;
  ordered.resize(cloud.size(), cloud.sh_degree);
  const std::size_t rest = std::size_t(cloud.rest_count()) * 3;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    double least = INFINITY;
    std::size_t from = 0;
    for (std::size_t j = 0; j < std::size_t(cloud.size()); ++j) {
      double distance = 0;
      for (std::size_t a = 0; a < 3; ++a)
        distance += std::pow(double(reference.position[i * 3 + a]) - double(cloud.position[j * 3 + a]), 2);
      if (distance < least) {
        least = distance;
        from = j;
      }
    }
    const auto copy = [&](const std::vector<float>& source, std::vector<float>& to, std::size_t width) {
      std::copy_n(source.begin() + std::ptrdiff_t(from * width), width, to.begin() + std::ptrdiff_t(i * width));
    };
    copy(cloud.position, ordered.position, 3);
    copy(cloud.rotation, ordered.rotation, 4);
    copy(cloud.log_scale, ordered.log_scale, 3);
    copy(cloud.logit_opacity, ordered.logit_opacity, 1);
    copy(cloud.sh_dc, ordered.sh_dc, 3);
    copy(cloud.sh_rest, ordered.sh_rest, rest);
  }
  return ordered;
}

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
