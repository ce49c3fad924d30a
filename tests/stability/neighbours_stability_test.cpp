// k nearest neighbours and RBF interpolation.                                                    Eqs. (8)-(9)
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "ngs/ops/field/rbf.h"
#include "ngs/ops/field/rbf_kernels.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/random.h"
#include "support/stability.h"

// Nearest neighbours and the weights of Eq. (8): a reference in long double, and the textbook form in float.

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
  for (int k = 0; k < 3; ++k) {
    aa += a[k] * a[k];
    ab = std::fma(a[k], b[k], ab);
    bb += b[k] * b[k];
  }
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

namespace ngs {
namespace {

using namespace test::knn;
using test::Random;
using test::Worst;

bool agrees(const KnnGraph& graph, const std::vector<float>& points, const float* query) {
  const auto order = brute_force(points, query);
  return std::equal(graph.index.begin(), graph.index.begin() + graph.neighbours, order.begin());
}

/// One query's feature and weights.
RbfField field_at(const std::vector<float>& query, const std::vector<float>& boundary,
                  const std::vector<float>& feature, const KnnGraph& graph, double width) {
  RbfField field;
  rbf_forward({}, {rows(query), rows(boundary), {feature.data(), std::int64_t(feature.size()), 1}, &graph, width},
              field);
  return field;
}

}  // namespace

HARD_CASE("knn: squared distances keep their accuracy far from the origin", "offset, world", {0, 1e2, 1e4, 1e6}, 0.87,
          {"|a|² - 2 a·b + |b|²", 2e14}) {
  std::vector<float> points = random.uniform_vector<float>(30, -1, 1), query = random.uniform_vector<float>(3, -1, 1);
  for (float& x : points) x += float(h);
  for (float& x : query) x += float(h);
  const KnnGraph graph = nearest_points({}, rows(points), rows(query), 4);
  for (std::size_t k = 0; k < 4; ++k) {
    const Real want = exact_dist2(&points[graph.index[k] * 3], query.data());
    if (want == 0) continue;
    worst.ours(graph.dist2[k], want);
    worst.naive(expanded_dist2(&points[graph.index[k] * 3], query.data()), want);
  }
}

HARD_CASE("knn: the neighbours are those of exact arithmetic, far from the origin too", "offset, world",
          {0, 1e2, 1e4, 1e6}, 0, {"nearest by |a|² - 2 a·b + |b|²", test::kWrong}) {
  std::vector<float> points = random.uniform_vector<float>(60, -1, 1), query = random.uniform_vector<float>(3, -1, 1);
  for (float& x : points) x += float(h);
  for (float& x : query) x += float(h);
  worst.ours_is(agrees(nearest_points({}, rows(points), rows(query), kNeighbours), points, query.data()));
  std::size_t naive = 0;
  for (std::size_t i = 1; i < 20; ++i)
    if (expanded_dist2(&points[i * 3], query.data()) < expanded_dist2(&points[naive * 3], query.data())) naive = i;
  worst.naive_is(naive == brute_force(points, query.data())[0]);
}

HARD_CASE("rbf: two neighbours at nearly equal distance have nearly equal weights at any width", "width, world",
          {1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}, 0, {"exponents as rounding leaves them", test::kWrong}) {
  const auto on_sphere = [&](Vec3<double> centre, double radius) {
    const double z = random.uniform(-1, 1), phi = random.uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
    return Vec3<float>{float(centre.x + radius * r * std::cos(phi)), float(centre.y + radius * r * std::sin(phi)),
                       float(centre.z + radius * z)};
  };
  const Vec3<float> q = on_sphere({0, 0, 0}, 1), a = on_sphere({q.x, q.y, q.z}, 0.7),
                    b = on_sphere({q.x, q.y, q.z}, 0.7);
  const bool a_nearer = exact_dist2(&q.x, &a.x) <= exact_dist2(&q.x, &b.x);
  const Vec3<float> near = a_nearer ? a : b, far = a_nearer ? b : a;
  const float x[6] = {near.x, near.y, near.z, far.x, far.y, far.z}, inv_2h2 = float(1 / (2 * h * h));
  const std::uint32_t nearest[2] = {0, 1};
  float w[2];
  rbf_weights<float>(q, {x, 2}, {nearest, 2}, inv_2h2, w);
  worst.ours_is(w[0] >= w[1] && std::abs(w[0] + w[1] - 1) < 1e-6f);
  const float naive = std::exp(-dot(near - far, (q - near) + (q - far)) * inv_2h2);
  worst.naive_is(std::isfinite(naive) && naive <= 1);
}

HARD_CASE("knn: duplicates of the query come first, with distance exactly 0", "bits of a coordinate", {8, 16, 24}, 0,
          {"|a|² - 2 a·b + |b|² = 0", test::kWrong}) {
  std::vector<float> points = random.uniform_vector<float>(60, -1, 1);
  std::vector<float> query = random.uniform_vector<float>(3, -1, 1);
  for (float& x : query) x = float(std::ldexp(std::nearbyint(std::ldexp(x, int(h))), -int(h)));
  const int copies = std::array{1, 3, 20}[std::size_t(random.below(3))];
  for (int i = 0; i < copies; ++i) points.insert(points.end(), query.begin(), query.end());
  const KnnGraph graph = nearest_points({}, rows(points), rows(query), kNeighbours);
  for (std::size_t k = 0; k < std::size_t(std::min(copies, kNeighbours)); ++k)
    worst.ours_is(graph.index[k] == 20 + k && graph.dist2[k] == 0);
  worst.naive_is(expanded_dist2(query.data(), query.data()) == 0);
}

HARD_CASE("knn: the unit of the world does not change the neighbours", "scale", {1, 1e-6, 1e6, 1e-15, 1e15}, 0,
          {"distances compared up to 1e-7", test::kWrong}) {
  std::vector<float> points = random.uniform_vector<float>(60, -1, 1), query = random.uniform_vector<float>(3, -1, 1);
  for (auto* v : {&points, &query})
    for (float& x : *v) x *= float(h);
  worst.ours_is(agrees(nearest_points({}, rows(points), rows(query), kNeighbours), points, query.data()));
  const auto order = brute_force(points, query.data());
  worst.naive_is(exact_dist2(&points[order[7] * 3], query.data()) - exact_dist2(&points[order[0] * 3], query.data()) >
                 1e-7L);
}

HARD_CASE("rbf: weights keep full accuracy far from the boundary", "distance, widths", {0, 1, 5, 20, 40, 1e3, 1e5}, 3.2,
          {"exp(-d²/2h²) as printed", test::kWrong}) {
  const Cluster c(random, 0.35, h, 0);
  worst.ours_ratio(c.worst_ratio(c.ours()));
  worst.naive_ratio(c.worst_ratio(c.as_printed(false)));
}

HARD_CASE("rbf: weights keep full accuracy where d_j² and d_0² nearly cancel", "distance, widths", {1, 40, 1e3, 1e5},
          1.5, {"softmax of d_j² - d_0²", 3e6}) {
  const Cluster c(random, 0.35, h, 0, 0.35 / std::max(1.0, h));  // neighbours as close together as the exponent allows
  worst.ours_ratio(c.worst_ratio(c.ours()));
  worst.naive_ratio(c.worst_ratio(c.as_printed(true)));
}

HARD_CASE("rbf: weights keep full accuracy far from the origin", "offset, world", {0, 1e2, 1e4, 1e6}, 2,
          {"d² as |q|² - 2 q·x + |x|²", test::kWrong}) {
  const Cluster c(random, 0.35, 1, h);
  std::vector<float> d2(kNeighbours);
  for (std::size_t j = 0; j < kNeighbours; ++j) d2[j] = expanded_dist2(&c.q.x, &c.x[3 * c.nearest[j]]) * c.inv_2h2();
  worst.ours_ratio(c.worst_ratio(c.ours()));
  worst.naive_ratio(c.worst_ratio(c.normalised(d2)));
}

HARD_CASE("rbf: for width -> 0 the nearest neighbour has weight 1", "width, world", {1e-2, 1e-6, 1e-15, 1e-25}, 0,
          {"1 / (2 h²) in float", test::kWrong}) {
  const std::vector<float> boundary = random.uniform_vector<float>(60, -10, 10),
                           feature = random.uniform_vector<float>(20, 0, 1),
                           query = random.uniform_vector<float>(3, -10, 10);
  const KnnGraph graph = nearest_points({}, rows(boundary), rows(query), kNeighbours);
  if (graph.dist2[1] - graph.dist2[0] < 0.03f) return;
  const RbfField field = field_at(query, boundary, feature, graph, h);
  worst.ours_is(field.weight[0] == 1 && field.feature[0] == feature[graph.index[0]]);
  const float inverse = 1 / (2 * float(h) * float(h));
  float sum = 0;
  for (const float d2 : graph.dist2) sum += std::exp(-(d2 - graph.dist2[0]) * inverse);
  worst.naive_is(std::exp(-(graph.dist2[0] - graph.dist2[0]) * inverse) / sum == 1);
}

HARD_CASE("rbf: for width -> infinity all neighbours have equal weights", "width, world", {1e4, 1e10, 1e30, 1e200}, 0,
          "not applicable: exp(-d²/2h²) is 1 for an infinite h too") {
  const std::vector<float> boundary = random.uniform_vector<float>(60, -1, 1),
                           feature = random.uniform_vector<float>(20, 0.5, 1),
                           query = random.uniform_vector<float>(3, -1, 1);
  const KnnGraph graph = nearest_points({}, rows(boundary), rows(query), kNeighbours);
  const RbfField field = field_at(query, boundary, feature, graph, h);
  for (const float w : field.weight) worst.ours(w, 1 / Real(kNeighbours));
}

HARD_CASE("rbf: coincident boundary Gaussians share the weight equally", "distance, world", {0, 1, 1e10, 1e18}, 0,
          {"exp(-d²/2h²) as printed, h = 0.35", test::kWrong}) {
  std::vector<float> boundary;
  for (int i = 0; i < kNeighbours; ++i) boundary.insert(boundary.end(), {0.5f, 0.25f, -1.f});
  const std::vector<float> query{0.5f + float(h * random.uniform(0.5, 1)), 0.25f, -1.f},
      feature = random.uniform_vector<float>(kNeighbours, 0, 1);
  const KnnGraph graph = nearest_points({}, rows(boundary), rows(query), kNeighbours);
  const double width = auto_rbf_width({}, rows(boundary), kNeighbours, 1.0);
  const RbfField field = field_at(query, boundary, feature, graph, width);
  for (const float w : field.weight) worst.ours(w, 1 / Real(kNeighbours));
  float sum = 0;
  for (const float d2 : graph.dist2) sum += std::exp(-d2 / (2 * 0.35f * 0.35f));
  for (const float d2 : graph.dist2) worst.naive(std::exp(-d2 / (2 * 0.35f * 0.35f)) / sum, 1 / Real(kNeighbours));
}

HARD_CASE("rbf: the unit of the world does not change the weights", "log2 of the unit", {0, 20, 40, -20, -40}, 0,
          {"the printed width of 0.35 in any unit", test::kWrong}) {
  std::vector<float> boundary = random.uniform_vector<float>(24, -1, 1), query = random.uniform_vector<float>(3, -1, 1);
  std::vector<float> weight[2], naive[2];
  for (int k = 0; k < 2; ++k) {
    const float unit = k == 0 ? 1.f : std::ldexp(1.f, int(h));
    std::vector<float> b = boundary, q = query;
    for (auto* v : {&b, &q})
      for (float& x : *v) x *= unit;
    const KnnGraph graph = nearest_points({}, rows(b), rows(q), kNeighbours);
    const std::vector<float> feature(kNeighbours, 1.f);
    weight[k] = field_at(q, b, feature, graph, auto_rbf_width({}, rows(b), kNeighbours, 0.5)).weight;
    for (std::size_t j = 0; j < kNeighbours; ++j) naive[k].push_back(std::exp(-graph.dist2[j] / (2 * 0.35f * 0.35f)));
  }
  worst.ours_is(weight[0] == weight[1]);
  worst.naive_is(naive[0] == naive[1]);
}

HARD_CASE("rbf: without boundary Gaussians every feature is zero", "|B|", {8, 1, 0}, 0,
          {"Σ φ s / Σ φ as printed", test::kWrong}) {
  const auto boundary = random.uniform_vector<float>(std::size_t(h) * 3, -1, 1),
             feature = random.uniform_vector<float>(std::size_t(h), 0.5, 1),
             query = random.uniform_vector<float>(3, -1, 1);
  const KnnGraph graph = nearest_points({}, rows(boundary), rows(query), kNeighbours);
  const RbfField field = field_at(query, boundary, feature, graph, 1.0);
  Real want = 0, weights = 0;
  float printed = 0, phi_sum = 0;
  for (std::size_t j = 0; j < graph.index.size(); ++j) {
    const Real phi = std::exp(-Real(graph.dist2[j]) / 2);
    want += phi * feature[graph.index[j]];
    weights += phi;
    printed += float(phi) * feature[graph.index[j]];
    phi_sum += float(phi);
  }
  if (h > 0) want /= weights;
  const auto as_wanted = [&](float f) { return std::abs(f - float(want)) <= 1e-5f * float(want); };
  worst.ours_is(as_wanted(field.feature[0]) && field.weight.size() == std::size_t(h));
  worst.naive_is(as_wanted(printed / phi_sum));
}

}  // namespace ngs
