#include "ngs/ops/field/hash_grid.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/random.h"

namespace ngs {
namespace {

const HashBox<float> kUnitBox{{0.5f, 0.5f, 0.5f}, {1, 1, 1}};

std::vector<float> encode(const HashGridConfig& config, const HashBox<float>& box, const ParamStore& store,
                          const std::vector<float>& points) {
  std::vector<float> out;
  HashGrid(config, box, 0).forward({}, store, {points.data(), std::int64_t(points.size() / 3)}, out);
  return out;
}

}  // namespace

TEST_CASE("hash levels grow geometrically and turn from dense to hashed when the table is full") {
  const HashGridConfig config{
      .levels = 8, .features = 2, .log2_table = 15, .base_resolution = 16, .max_resolution = 512};
  const auto levels = hash_levels(config);
  REQUIRE(levels.size() == 8);
  CHECK(levels[0].scale == 15);
  CHECK(levels[0].resolution == 16);
  CHECK(levels[0].size == 4096);
  CHECK(levels[0].dense);
  CHECK(levels[7].scale == doctest::Approx(511));
  CHECK(levels[7].size == 32768);
  for (std::size_t l = 1; l < 8; ++l) {
    CHECK((levels[l].scale + 1) / (levels[l - 1].scale + 1) == doctest::Approx(std::pow(32.0, 1.0 / 7)).epsilon(1e-5));
    CHECK(levels[l].offset == levels[l - 1].offset + levels[l - 1].size);
    CHECK(levels[l].dense == (std::pow(double(levels[l].resolution), 3) <= levels[l].size));
  }
}

TEST_CASE("the spatial hash uses the primes of instant-ngp") {
  CHECK(hash_vertex(1, 0, 0) == 1u);
  CHECK(hash_vertex(0, 1, 0) == 2654435761u);
  CHECK(hash_vertex(0, 0, 1) == 805459861u);
  CHECK(hash_vertex(7, 3, 2) == (7u ^ (3u * 2654435761u) ^ (2u * 805459861u)));
}

TEST_CASE("a hash grid reproduces the table's value at a vertex") {
  HashGridConfig config{.levels = 1, .features = 4, .log2_table = 12, .base_resolution = 9, .max_resolution = 9};
  ParamStore store;
  add_hash_grid(store, "hash", config, 1);
  // scale 8: vertex i lies at (i - 0.5) / 8
  const std::vector<float> out = encode(config, kUnitBox, store, {2.5f / 8, 0.5f / 8, 5.5f / 8});
  const std::size_t entry = 3 + 9 * (1 + 9 * 6);
  for (std::size_t f = 0; f < 4; ++f) CHECK(out[f] == store.values[entry * 4 + f]);
}

TEST_CASE("the hash box is a cube about the points with the padding on every side") {
  const std::vector<float> points{0, 0, 0, 4, 1, 2};
  const HashBox<float> box = hash_box({points.data(), 2}, 0.5);
  CHECK(box.centre.y == 0.5f);
  CHECK(box.inv_extent.x == doctest::Approx(0.2));
  CHECK(box.inv_extent.z == box.inv_extent.x);
  const std::vector<float> same{2, 3, 4, 2, 3, 4};
  CHECK(hash_box({same.data(), 2}, 0).inv_extent.x == 0);
  CHECK(hash_box({nullptr, 0}, 0).inv_extent.x == 0);
}

TEST_CASE("a hash grid is continuous across cell faces") {
  const HashGridConfig config{.levels = 5, .features = 2, .log2_table = 7, .base_resolution = 3, .max_resolution = 33};
  ParamStore store;
  add_hash_grid(store, "hash", config, 4);
  for (std::size_t l = 0; l < 5; ++l) {
    const double scale = double(hash_levels(config)[l].scale);
    const float face = float((std::floor(scale / 2) + 0.5) / scale);
    const auto below = encode(config, kUnitBox, store, {std::nextafter(face, 0.f), 0.4f, 0.7f});
    const auto above = encode(config, kUnitBox, store, {std::nextafter(face, 1.f), 0.4f, 0.7f});
    for (std::size_t i = 0; i < below.size(); ++i) CHECK(std::abs(below[i] - above[i]) < 1e-8f);  // values are 1e-4
  }
}

TEST_CASE("the hash grid gives the same bytes for 1 and 7 threads and accumulates into store.grads") {
  const HashGridConfig config;
  ParamStore a;
  add_hash_grid(a, "hash", config, 3);
  ParamStore b = a;
  test::Random random(2);
  const auto points = random.uniform_vector<float>(3 * 3000, 0, 1),
             grad = random.uniform_vector<float>(3000 * 16, -1, 1);
  const Rows<const float, 3> rows{points.data(), 3000};
  const HashGrid grid(config, kUnitBox, 0);
  const Exec one{.threads = 1}, seven{.threads = 7};
  std::vector<float> out1, out7;
  grid.forward(one, a, rows, out1);
  grid.forward(seven, b, rows, out7);
  grid.backward(one, a, rows, grad);
  grid.backward(seven, b, rows, grad);
  CHECK(out1 == out7);
  CHECK(a.grads == b.grads);
  const std::vector<float> once = a.grads;
  grid.backward(one, a, rows, std::vector<float>(3000 * 16, 0.f));
  CHECK(a.grads == once);
}

TEST_CASE("a hash grid of no points is empty") {
  ParamStore store;
  add_hash_grid(store, "hash", {}, 1);
  CHECK(encode({}, kUnitBox, store, {}).empty());
}

}  // namespace ngs
