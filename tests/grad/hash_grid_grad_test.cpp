// Mutants this kills: a prime changed in one direction only, corner weights in a different order from the corners.
#include <doctest/doctest.h>

#include "ngs/ops/field/hash_grid.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

/// Levels 0-1 dense, 2-3 hashed into 256 entries (with many collisions).
struct HashCase {
  HashGridConfig config{.levels = 4, .features = 2, .log2_table = 8, .base_resolution = 2, .max_resolution = 40};
  std::vector<HashLevel> level;
  std::vector<double> table, point;
  std::int64_t queries;

  HashCase(test::Random& random, std::int64_t n) : queries(n) {
    level = hash_levels(config);
    table = random.uniform_vector((level.back().offset + level.back().size) * 2, -1, 1);
    point = random.uniform_vector(std::size_t(n) * 3, -1.4, 1.4);  // the box is [-1, 1]: some lie outside
  }
  template <class T>
  HashGridView<T> view(const std::vector<T>& tab, const std::vector<T>& pts) const {
    return {
        level.data(), config.levels, {{T(0), T(0), T(0)}, {T(0.5), T(0.5), T(0.5)}}, tab.data(), {pts.data(), queries}};
  }
  template <class T>
  std::vector<T> forward(const std::vector<T>& tab, const std::vector<T>& pts) const {
    std::vector<T> out(std::size_t(queries) * 8);
    const HashForward<T, 2> kernel{view(tab, pts), out.data()};
    for (std::int64_t i = 0; i < queries * config.levels; ++i) kernel(i);
    return out;
  }
};

}  // namespace

TEST_CASE("hash grid: backward equals the adjoint of forward for the table") {
  test::Random random(21);
  for (const std::int64_t n : {1, 2, 100}) {
    const HashCase c(random, n);
    REQUIRE((c.level[1].dense && !c.level[2].dense));
    const auto v = random.uniform_vector(c.table.size(), -1, 1), u = random.uniform_vector(std::size_t(n) * 8, -1, 1);
    const auto dual = c.forward(test::seed(c.table, v), test::constant<test::DualD>(c.point));
    std::vector<double> g(c.table.size(), 0.0);
    const HashBackwardTable<double, 2> kernel{c.view(c.table, c.point), u.data(), g.data()};
    for (int l = 0; l < c.config.levels; ++l) kernel(l);
    CHECK(test::adjoint_difference(test::dot(u, test::deriv(dual)), test::dot(g, v)) < 1e-12);
  }
}

}  // namespace ngs
