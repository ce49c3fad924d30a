#pragma once
// Nearest neighbours and the weights of Eq. (8): a reference in long double, and the textbook form in float.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "ngs/ops/field/rbf_kernels.h"
#include "support/random.h"
#include "support/stability.h"

namespace ngs::test::knn {

using Real = long double;

inline constexpr int kNeighbours = 8;

inline Rows<const float, 3> rows(const std::vector<float>& v) { return {v.data(), std::int64_t(v.size() / 3)}; }

inline Real exact_dist2(const float* a, const float* b) {
  Real sum = 0;
  for (int k = 0; k < 3; ++k) sum += (Real(a[k]) - b[k]) * (Real(a[k]) - b[k]);
  return sum;
}
/// |a|² - 2 a·b + |b|² with fused middle products, as in a matrix product.
inline float expanded_dist2(const float* a, const float* b) {
  float aa = 0, ab = 0, bb = 0;
  for (int k = 0; k < 3; ++k) aa += a[k] * a[k], ab = std::fma(a[k], b[k], ab), bb += b[k] * b[k];
  return aa - 2 * ab + bb;
}
/// Brute force: indices sorted by (distance, index).
inline std::vector<std::uint32_t> brute_force(const std::vector<float>& points, const float* query) {
  std::vector<std::uint32_t> order(points.size() / 3);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
    return exact_dist2(&points[a * 3], query) < exact_dist2(&points[b * 3], query);
  });
  return order;
}
/// One query and its neighbours, sorted exactly, with the reference exponents.
struct Cluster {
  float h;
  std::vector<float> x;
  Vec3<float> q;
  std::vector<std::uint32_t> nearest = std::vector<std::uint32_t>(kNeighbours);
  std::vector<Real> e = std::vector<Real>(kNeighbours);  // (d_j² - d_0²) / 2h²
  std::vector<double> condition = std::vector<double>(kNeighbours, 1.0);

  Cluster(Random& random, double width, double distance, double origin, double spread = 0.5)
      : h(float(width)), x(random.uniform_vector<float>(3 * kNeighbours, -spread, spread)) {
    for (std::size_t j = 0; j < kNeighbours; ++j) x[3 * j] += float(origin);
    const double z = random.uniform(-1, 1), phi = random.uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
    q = {float(origin + distance * width * r * std::cos(phi)), float(distance * width * r * std::sin(phi)),
         float(distance * width * z)};
    nearest = brute_force(x, &q.x);
    for (std::size_t j = 0; j < kNeighbours; ++j) {
      const float *x0 = &x[3 * nearest[0]], *xj = &x[3 * nearest[j]];
      e[j] = (exact_dist2(&q.x, xj) - exact_dist2(&q.x, x0)) * inv_2h2();
      // The terms of the exponent's dot product may cancel; the rounding errors of the terms need not.
      for (int a = 0; a < 3; ++a)
        condition[j] += double(std::abs((Real(x0[a]) - xj[a]) * (2 * Real((&q.x)[a]) - x0[a] - xj[a])) * inv_2h2());
    }
  }
  float inv_2h2() const { return 1.f / (2 * h * h); }

  std::vector<float> ours() const {
    std::vector<float> w(kNeighbours);
    rbf_weights<float>(q, rows(x), {nearest.data(), kNeighbours}, inv_2h2(), w.data());
    return w;
  }
  std::vector<float> normalised(std::vector<float> exponent) const {
    float sum = 0;
    for (float& v : exponent) sum += v = std::exp(-v);
    for (float& v : exponent) v /= sum;
    return exponent;
  }
  std::vector<float> as_printed(bool subtract_nearest) const {
    std::vector<float> d2(kNeighbours);
    for (std::size_t j = 0; j < kNeighbours; ++j) {
      const auto d = q - vec3<float>(&x[3 * nearest[j]]);
      d2[j] = dot(d, d);
    }
    const float nearest_d2 = subtract_nearest ? d2[0] : 0;
    for (float& v : d2) v = (v - nearest_d2) * inv_2h2();
    return normalised(d2);
  }
  double worst_ratio(const std::vector<float>& w) const {
    Real sum = 0;
    for (const Real v : e) sum += std::exp(-v);
    double shared = 0;  // the normaliser adds every neighbour's rounding error to all weights
    for (std::size_t l = 0; l < kNeighbours; ++l) shared += double(std::exp(-e[l]) / sum) * condition[l];
    double worst = 0;
    for (std::size_t j = 0; j < kNeighbours; ++j)
      if (e[j] < 80) {
        const double r = ratio(w[j], double(std::exp(-e[j]) / sum), condition[j] + shared);
        worst = r >= 0 ? std::max(worst, r) : kWrong;
      }
    return worst;
  }
};

}  // namespace ngs::test::knn
