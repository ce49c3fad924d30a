// Hash encoding and the FiLM network.                                                         Eqs. (10)-(15)
#include <doctest/doctest.h>

#include "ngs/ops/field/film_mlp_kernels.h"
#include "ngs/ops/field/hash_grid.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

/// One dense level of `cells` + 1 vertices per axis over the box [-1, 1]³ about `centre`, one feature.
struct Level {
  HashLevel level;
  HashBox<float> box;
  std::vector<float> table;

  Level(Random& random, int cells, float centre = 0, double table_size = 1)
      : level{float(cells), std::uint32_t(cells) + 1, 0, 0, true}, box{{centre, centre, centre}, {0.5f, 0.5f, 0.5f}} {
    const auto n = std::size_t(level.resolution);
    table = random.uniform_vector<float>((n * n * n + 7) / 8 * 8, 0.5 * table_size, table_size);
    level.size = std::uint32_t(table.size());
  }
  HashGridView<float> view(const float* point) const { return {&level, 1, box, table.data(), {point, 1}}; }
  float at(const float* point) const {
    float out;
    HashForward<float, 1>{view(point), &out}(0);
    return out;
  }
  float vertex(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    std::uint32_t entry = x + level.resolution * (y + level.resolution * z);
    if (entry >= level.size) entry -= level.size;
    return table[entry];
  }
};

}  // namespace

HARD_CASE("hash grid: a point on a vertex reads only its entry, a point on a face nothing beyond the face", "cells",
          {4, 16, 32}, 0, "not applicable: the blend is the same in every form") {
  const Level level(random, int(h));
  std::uint32_t v[3];
  float p[3];
  for (int a = 0; a < 3; ++a) {  // unit · cells + 0.5 = v exactly
    v[a] = std::uint32_t(1 + random.below(int(h) - 1));
    p[a] = 2 * ((float(v[a]) - 0.5f) / float(h) - 0.5f);
  }
  worst.ours_is(level.at(p) == level.vertex(v[0], v[1], v[2]));
  p[1] += 0.3f / float(h);
  p[2] += 0.7f / float(h);
  Level blind = level;
  for (std::uint32_t y = 0; y < level.level.resolution; ++y)
    for (std::uint32_t z = 0; z < level.level.resolution; ++z)
      blind.table[(v[0] + 1) % level.level.resolution + level.level.resolution * (y + level.level.resolution * z)] =
          1e30f;
  worst.ours_is(blind.at(p) == level.at(p));
}

HARD_CASE("hash grid: points outside the box encode as the nearest point of the box", "distance beyond, world",
          {1e-3, 1, 1e6, 1e30}, 0, {"cell index of a negative coordinate", test::kWrong}) {
  const Level level(random, 16);
  float outside[3], surface[3];
  for (int a = 0; a < 3; ++a) {
    const bool low = random.below(2) == 0;
    surface[a] = low ? -1.f : 1.f;
    outside[a] = surface[a] + (low ? -float(h) : float(h));
  }
  worst.ours_is(level.at(outside) == level.at(surface));
  const double cell = std::floor((0.5 + 0.5 * double(outside[0])) * 16 + 0.5);
  worst.naive_is(cell >= 0 && cell <= 16);
}

HARD_CASE("hash grid: boxes without extent on some axes, or on all, encode their middle", "axes without extent",
          {0, 1, 2, 3}, 0, {"(x - lo) / (hi - lo)", test::kWrong}) {
  std::vector<float> points = random.uniform_vector<float>(30, -1, 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (int(i % 3) < int(h)) points[i] = 0.25f;
  HashGridConfig config{.levels = 4, .max_resolution = 64};
  ParamStore store;
  const std::size_t offset = add_hash_grid(store, "hash", config, 1);
  const HashGrid grid(config, hash_box({points.data(), 10}, 0), offset);
  std::vector<float> out;
  grid.forward({}, store, {points.data(), 10}, out);
  bool fine = true;
  for (const float x : out) fine &= std::isfinite(x);
  if (h == 3) fine &= std::equal(out.begin(), out.begin() + 8, out.begin() + 8);
  worst.ours_is(fine);
  float low = INFINITY, high = -INFINITY;  // of x
  for (std::size_t i = 0; i < points.size(); i += 3) {
    low = std::min(low, points[i]);
    high = std::max(high, points[i]);
  }
  const float unit = (points[0] - low) / (high - low);
  worst.naive_is(unit >= 0 && unit <= 1);
}

HARD_CASE("hash grid: levels with more than 1625 vertices per axis stay within their hash table", "finest resolution",
          {64, 1625, 1626, 4096, 65536}, 0, {"resolution³ in 32 bits", test::kWrong}) {
  HashGridConfig config{.levels = 2, .log2_table = 15, .base_resolution = 2, .max_resolution = int(h)};
  const std::vector<HashLevel> levels = hash_levels(config);
  const HashLevel& fine = levels[1];
  const std::uint64_t vertices = std::uint64_t(fine.resolution) * fine.resolution * fine.resolution;
  const HashBox<float> box{{0, 0, 0}, {0.5f, 0.5f, 0.5f}};
  const Vec3<float> p{float(random.uniform(-2, 2)), float(random.uniform(-2, 2)), float(random.uniform(-2, 2))};
  const HashCell<float> cell = hash_cell(fine, box, p);
  bool inside = fine.dense == (vertices <= fine.size) && fine.size <= (1u << 15);
  for (const std::uint32_t entry : cell.entry) inside &= entry >= fine.offset && entry < fine.offset + fine.size;
  for (const float f : cell.frac) inside &= f >= 0 && f <= 1;
  worst.ours_is(inside);
  worst.naive_is(std::uint64_t(fine.resolution * fine.resolution * fine.resolution) == vertices);
}

HARD_CASE("hash grid: a box far from the origin is encoded as accurately as one at it", "centre, world",
          {0, 1e2, 1e4, 1e6}, 0.12, {"x · scale - lo · scale", 2e4}) {
  Level level(random, 16, float(h));
  const float inv = 0.3f;
  level.box.inv_extent = {inv, inv, inv};
  float p[3];
  Real want = 0, at[3], frac[3], vertex[3];
  for (int a = 0; a < 3; ++a) {
    p[a] = float(h + random.uniform(-1, 1));
    at[a] = std::min<Real>(std::max<Real>(0.5L + (Real(p[a]) - float(h)) * inv, 0), 1) * 16 + 0.5L;
    vertex[a] = std::floor(at[a]);
    frac[a] = at[a] - vertex[a];
  }
  const auto blend = [&](const Real* f) {
    Real sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      Real w = 1;
      for (int a = 0; a < 3; ++a) w *= (corner >> a & 1) ? f[a] : 1 - f[a];
      sum += w * level.vertex(std::uint32_t(vertex[0]) + (corner & 1), std::uint32_t(vertex[1]) + (corner >> 1 & 1),
                              std::uint32_t(vertex[2]) + unsigned(corner >> 2));
    }
    return sum;
  };
  want = blend(frac);
  worst.ours(level.at(p), want,
             4 * 17);  // rounding of the position in cells, across table entries of a factor 2
  Real shifted[3];
  for (int a = 0; a < 3; ++a) {
    const float cell = p[a] * (16 * inv) - (float(h) - 0.5f / inv) * (16 * inv) + 0.5f;
    shifted[a] = Real(cell) - vertex[a];
  }
  worst.naive(float(blend(shifted)), want, 4 * 17);
}

HARD_CASE("hash grid: a small entry next to a large one keeps its accuracy at its own vertex", "ratio of entries",
          {1, 1e3, 1e6, 1e9}, 1.7, {"a + t (b - a)", 2000}) {
  Level level(random, 4);
  for (std::size_t i = 0; i < level.table.size(); ++i)
    if (i % level.level.resolution % 2 == 0) level.table[i] *= float(h);
  const float t = 1 - float(random.uniform(0.5, 1)) * 0x1p-12f;
  const float p[3] = {2 * ((2 - 0.5f + t) / 4 - 0.5f), 2 * ((1 - 0.5f) / 4 - 0.5f), 2 * ((1 - 0.5f) / 4 - 0.5f)};
  const HashCell<float> cell = hash_cell(level.level, level.box, {p[0], p[1], p[2]});
  const float a = level.table[cell.entry[0]], b = level.table[cell.entry[1]];
  const Real want = (1 - Real(cell.frac[0])) * a + Real(cell.frac[0]) * b;
  worst.ours(level.at(p), want);
  worst.naive(a + cell.frac[0] * (b - a), want);
}

HARD_CASE("hash grid: the table's gradient sums to the incoming gradients", "queries", {1, 100, 3000}, 0.11,
          "not applicable: the sum is sequential in every form; its length is the condition", 50) {
  const Level level(random, 4);
  const std::vector<float> points = random.uniform_vector<float>(std::size_t(h) * 3, -1.2, 1.2),
                           upstream = random.uniform_vector<float>(std::size_t(h), 0, 1);
  std::vector<float> grad(level.table.size(), 0.f);
  HashGridView<float> view = level.view(points.data());
  view.point.n = std::int64_t(h);
  HashBackwardTable<float, 1>{view, upstream.data(), grad.data()}(0);
  Real in = 0, out = 0;
  for (const float g : upstream) in += g;
  for (const float g : grad) out += g;
  worst.ours_ratio(std::abs(double(out / in - 1)) / (0x1p-23 * (8 + h)));
}

namespace {

/// A network in float packs, and a reference in long double with its condition.
struct Network {
  FilmMlpConfig config{.inputs = 8, .condition = 3, .hidden = 16, .layers = 2, .direction_degree = 0};
  std::vector<float> params, input, condition, density, rgb, context;
  static constexpr int kQueries = 5;

  Network(Random& random, double weight_size)
      : params(random.uniform_vector<float>(film_mlp_layout(config).size, -weight_size, weight_size)),
        input(random.uniform_vector<float>(kQueries * 8, -1, 1)),
        condition(random.uniform_vector<float>(kQueries * 3, 0, 1)),
        density(kQueries),
        rgb(kQueries * 3) {}
  FilmMlpData<float> data() {
    FilmMlpData<float> d;
    d.params = params.data();
    d.input = {input.data(), kQueries, 8};
    d.condition = {condition.data(), kQueries, 3};
    d.density = density.data();
    d.rgb = rgb.data();
    return d;
  }
  template <class L>
  void forward() {
    const std::size_t context_size = film_context_size<L>(config);
    const std::int64_t blocks = (kQueries + kBlockColumns<L> - 1) / kBlockColumns<L>;
    context.assign(context_size * std::size_t(blocks), 0.f);
    FilmMlpBlock<L> block(config);
    for (std::int64_t b = 0; b < blocks; ++b) block.forward(data(), b, &context[std::size_t(b) * context_size]);
  }
  struct Sum {
    Real value = 0, size = 0;
  };
  Sum affine(std::size_t weight, int cols, int row, const std::vector<Sum>& x, std::size_t bias) const {
    Sum y{params[bias + std::size_t(row)], std::abs(Real(params[bias + std::size_t(row)]))};
    for (int c = 0; c < cols; ++c) {
      const Real w = params[weight + std::size_t(row * cols + c)];
      y.value += w * x[std::size_t(c)].value;
      y.size += std::abs(w) * x[std::size_t(c)].size;
    }
    return y;
  }
  /// The four raw outputs of query q, with max(x, 0), or max(0, x), which makes 0 of NaN.
  std::vector<Sum> raw(int q, bool zero_first = false) const {
    const FilmMlpLayout at = film_mlp_layout(config);
    std::vector<Sum> x, c;
    for (int i = 0; i < 8; ++i)
      x.push_back({input[std::size_t(q * 8 + i)], std::abs(Real(input[std::size_t(q * 8 + i)]))});
    for (int i = 0; i < 3; ++i) c.push_back({condition[std::size_t(q * 3 + i)], condition[std::size_t(q * 3 + i)]});
    for (int l = 0; l < config.layers; ++l) {
      std::vector<Sum> next;
      for (int r = 0; r < config.hidden; ++r) {
        Sum h = affine(at.layer[l].weight, at.layer[l].inputs, r, x, at.layer[l].bias);
        if (l == 0) h.value = zero_first ? std::max<Real>(0, h.value) : std::max<Real>(h.value, 0);
        const Sum gamma = affine(at.layer[l].gamma_weight, 3, r, c, at.layer[l].gamma_bias),
                  beta = affine(at.layer[l].beta_weight, 3, r, c, at.layer[l].beta_bias);
        const Real y = gamma.value * h.value + beta.value;
        next.push_back({zero_first ? std::max<Real>(0, y) : std::max<Real>(y, 0), gamma.size * h.size + beta.size});
      }
      x = next;
    }
    std::vector<Sum> out;
    for (int r = 0; r < 4; ++r) out.push_back(affine(at.head_weight, config.hidden, r, x, at.head_bias));
    return out;
  }
};

}  // namespace

HARD_CASE("network: outputs stay as accurate as their sums, in eight lanes and in one", "weights", {0.1, 1, 10}, 0.69,
          "not applicable: a chain of dot products has one form") {
  Network n(random, h);
  n.forward<float>();
  const std::vector<float> density = n.density, rgb = n.rgb;
  n.forward<PackF>();
  worst.ours_is(density == n.density && rgb == n.rgb);
  for (int q = 0; q < Network::kQueries; ++q) {
    const auto raw = n.raw(q);
    for (int ch = 0; ch < 3; ++ch) {
      const Network::Sum& z = raw[std::size_t(1 + ch)];
      if (z.value < -80) continue;  // below float's normal numbers
      const Real s = 1 / (1 + std::exp(-z.value));
      worst.ours(n.rgb[std::size_t(q * 3 + ch)], s, 2 + 4 * z.size * (1 - s));
    }
    const Real z = raw[0].value, soft = z > 0 ? z + std::log1p(std::exp(-z)) : std::log1p(std::exp(z));
    if (z > -80) worst.ours(n.density[std::size_t(q)], soft, 2 + 4 * raw[0].size / (1 + std::exp(-z)) / soft);
  }
}

HARD_CASE("network: saturated colours and densities are finite and pass finite gradients", "head bias",
          {10, 100, 1e4, 1e30}, 0, {"log(1 + e^x) and e^x / (1 + e^x)", test::kWrong}) {
  Network n(random, 0.3);
  const FilmMlpLayout at = film_mlp_layout(n.config);
  for (std::size_t r = 0; r < 4; ++r) n.params[at.head_bias + r] = float(random.below(2) ? h : -h);
  n.forward<PackF>();
  std::vector<float> grad(n.params.size(), 0.f), input(n.input.size()), condition(n.condition.size()),
      one(Network::kQueries * 3, 1.f);
  FilmMlpBlock<PackF> block(n.config);
  block.backward(n.data(), {one.data(), one.data(), input.data(), condition.data()}, 0, n.context.data(), grad.data());
  bool fine = true;
  for (const auto* values : {&n.density, &n.rgb, &grad, &input, &condition})
    for (const float x : *values) fine &= std::isfinite(x);
  for (const float x : n.rgb) fine &= x >= 0 && x <= 1;
  for (const float x : n.density) fine &= x >= 0;
  worst.ours_is(fine);
  bool naive = true;
  for (int q = 0; q < Network::kQueries; ++q) naive &= std::isfinite(std::log(1 + std::exp(float(n.raw(q)[0].value))));
  worst.naive_is(naive);
}

HARD_CASE("network: a saturated colour keeps its gradient", "head bias", {1, 10, 20, 60}, 4.1, {"y (1 - y)", 4e6}) {
  Network n(random, 0);
  const FilmMlpLayout at = film_mlp_layout(n.config);
  const float bias = float(h * random.uniform(0.8, 1));
  n.params[at.head_bias + 1] = bias;
  n.forward<PackF>();
  std::vector<float> grad(n.params.size(), 0.f), zero(Network::kQueries, 0.f), one(Network::kQueries * 3, 1.f);
  FilmMlpBlock<PackF> block(n.config);
  block.backward(n.data(), {zero.data(), one.data(), nullptr, nullptr}, 0, n.context.data(), grad.data());
  const Real e = std::exp(-Real(bias)), want = Network::kQueries * e / ((1 + e) * (1 + e));
  const float y = n.rgb[0];
  worst.ours(grad[at.head_bias + 1], want);
  worst.naive(Network::kQueries * y * (1 - y), want);
}

HARD_CASE("network: a NaN in a query's input gives NaN in its output and in no other query", "NaNs", {0, 1}, 0,
          {"max(0, x) as ReLU, which makes 0 of NaN", test::kWrong}) {
  Network n(random, 1);
  const auto q = std::size_t(random.below(Network::kQueries));
  if (h > 0) n.input[q * 8 + std::size_t(random.below(8))] = NAN;
  n.forward<PackF>();
  bool fine = true, naive = true;
  for (std::size_t k = 0; k < Network::kQueries; ++k) {
    const bool wanted = h > 0 && k == q;
    fine &= std::isnan(n.density[k]) == wanted;
    naive &= std::isnan(n.raw(int(k), true)[0].value) == wanted;
  }
  worst.ours_is(fine);
  worst.naive_is(naive);
}

}  // namespace ngs
