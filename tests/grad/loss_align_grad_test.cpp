// Mutants this kills: a pixel that misses a node near the image border, the patch clipped in one pass only,
// 1/49 for a cut patch.
#include <doctest/doctest.h>

#include "ngs/ops/losses/loss_align_kernels.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

struct AlignCase {
  PixelGrid grid;
  int width, height;
  std::vector<double> colour, alpha, field_colour, field_alpha;
  std::vector<std::uint8_t> active;

  AlignCase(test::Random& random, PixelGrid g, int w, int h)
      : grid(g),
        width(w),
        height(h),
        colour(random.uniform_vector(std::size_t(w * h) * 3, 0, 1)),
        alpha(random.uniform_vector(std::size_t(w * h), 0, 1)),
        field_colour(random.uniform_vector(std::size_t(g.nodes()) * 3, 0, 1)),
        field_alpha(random.uniform_vector(std::size_t(g.nodes()), 0, 1)) {
    for (long long r = 0; r < g.nodes(); ++r) active.push_back(r % 5 != 1);
  }
  template <class T>
  struct Inputs {
    std::vector<T> colour, alpha, field_colour, field_alpha;
  };
  template <class T>
  AlignView<T> view(const Inputs<T>& in) const {
    return {grid,
            {in.colour.data(), width, height},
            {in.alpha.data(), width, height},
            in.field_colour.data(),
            in.field_alpha.data(),
            active.data(),
            T(0.7),
            T(0.3)};
  }
  template <class T>
  struct Nodes {
    std::vector<T> colour, alpha, mean, share, term;
    explicit Nodes(std::size_t n) : colour(n * 3), alpha(n), mean(n * 3), share(n), term(n * 3) {}
    AlignNodes<T> view() { return {colour.data(), alpha.data(), mean.data(), share.data()}; }
  };
  template <class T>
  T loss(const Inputs<T>& in, Nodes<T>& nodes) const {
    const AlignForward<T> kernel{view(in), nodes.view(), nodes.term.data()};
    T sum(0);
    for (std::int64_t r = 0; r < grid.nodes(); ++r) {
      kernel(r);
      sum += nodes.term[std::size_t(r) * 3] + T(0.7) * nodes.term[std::size_t(r) * 3 + 1] +
             T(0.3) * nodes.term[std::size_t(r) * 3 + 2];
    }
    return T(2.5) * sum;
  }
  Inputs<double> inputs() const { return {colour, alpha, field_colour, field_alpha}; }
  Inputs<double> gradient() const {
    Nodes<double> nodes(std::size_t(grid.nodes()));
    const Inputs<double> in = inputs();
    loss(in, nodes);
    Inputs<double> g{std::vector<double>(colour.size()), std::vector<double>(alpha.size()),
                     std::vector<double>(field_colour.size()), std::vector<double>(field_alpha.size())};
    const AlignBackwardField<double> field{nodes.view(), 0.7, 2.5, g.field_colour.data(), g.field_alpha.data()};
    for (std::int64_t r = 0; r < grid.nodes(); ++r) field(r);
    const AlignBackwardImage<double> image{view(in), nodes.view(), 2.5, 0, 0, width, g.colour.data(), g.alpha.data()};
    for (int i = 0; i < width * height; ++i) image(i);
    return g;
  }
};

}  // namespace

TEST_CASE("loss_align: backward equals the adjoint of forward, at and beyond the image border") {
  test::Random random(51);
  const PixelGrid grids[] = {
      {4.5, 3.25, 1, 1, 1, 1}, {0.2, 0.1, 1.9, 2.3, 10, 6}, {-3, 0, 4, 1, 8, 16}, {0, 0, 2.5, 15, 9, 2}};
  for (const PixelGrid& grid : grids) {
    CAPTURE(grid.cols);
    const AlignCase c(random, grid, 20, 15);
    const auto v = AlignCase::Inputs<double>{
        random.uniform_vector(c.colour.size(), -1, 1), random.uniform_vector(c.alpha.size(), -1, 1),
        random.uniform_vector(c.field_colour.size(), -1, 1), random.uniform_vector(c.field_alpha.size(), -1, 1)};
    AlignCase::Nodes<test::DualD> nodes(std::size_t(grid.nodes()));
    const test::DualD loss =
        c.loss<test::DualD>({test::seed(c.colour, v.colour), test::seed(c.alpha, v.alpha),
                             test::seed(c.field_colour, v.field_colour), test::seed(c.field_alpha, v.field_alpha)},
                            nodes);
    const auto g = c.gradient();
    const double jtu_v = test::dot(g.colour, v.colour) + test::dot(g.alpha, v.alpha) +
                         test::dot(g.field_colour, v.field_colour) + test::dot(g.field_alpha, v.field_alpha);
    CHECK(test::adjoint_difference(loss.d, jtu_v) < 1e-11);
  }
}

TEST_CASE("loss_align: the image gradient agrees with extrapolated finite differences") {
  test::Random random(52);
  const AlignCase c(random, {2.2, 1.7, 2.1, 3.3, 6, 4}, 16, 14);
  const auto v = random.uniform_vector(c.colour.size(), -1, 1);
  const auto along = [&](double t) {
    AlignCase::Inputs<double> in = c.inputs();
    in.colour = test::moved(c.colour, v, t);
    AlignCase::Nodes<double> nodes(std::size_t(c.grid.nodes()));
    return c.loss(in, nodes);
  };
  CHECK(test::ridders_difference(test::ridders(along, 0.1), test::dot(c.gradient().colour, v)) < 1e-9);
}

}  // namespace ngs
