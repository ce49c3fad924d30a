#include <doctest/doctest.h>

#include "ngs/ops/losses/loss_mask_kernels.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

struct MaskCase {
  int width = 5, height = 4, objects = 3;
  std::vector<double> rendered;
  std::vector<std::vector<float>> target;
  std::vector<const float*> plane;
  std::vector<std::uint8_t> known;
  std::vector<float> weight;
  bool linear;

  MaskCase(test::Random& random, bool use_linear) : rendered(random.uniform_vector(60, -0.1, 1.1)), linear(use_linear) {
    rendered[0] = 0;
    rendered[1] = 1;
    rendered[2] = 5e-7;
    rendered[3] = 1 - 2e-7;  // beyond the clamp of the logarithm
    for (int k = 0; k < 3; ++k) target.push_back(random.uniform_vector<float>(20, 0, 1));
    target[0][0] = 1;
    target[1][0] = 0;
    target[0][1] = 1;
    for (const auto& t : target) plane.push_back(t.data());
    for (int p = 0; p < 20; ++p) known.push_back(p % 7 != 3);
    weight = random.uniform_vector<float>(20, 0.5, 1);
  }
  template <class T>
  T loss(const std::vector<T>& p, std::vector<T>* gradient = nullptr) const {
    std::vector<T> row(std::size_t(height), T(0));
    const MaskLossRow<T, T> kernel{width,
                                   objects,
                                   p.data(),
                                   plane.data(),
                                   known.data(),
                                   weight.data(),
                                   linear,
                                   T(0.3),
                                   T(1.7),
                                   row.data(),
                                   gradient ? gradient->data() : nullptr};
    T sum(0);
    for (int y = 0; y < height; ++y) {
      kernel(y);
      sum += row[std::size_t(y)];
    }
    return T(1.7) * sum;
  }
};

}  // namespace

TEST_CASE("loss_mask: the gradient equals the adjoint of the loss, also where predictions are clamped") {
  test::Random random(61);
  for (const bool linear : {false, true}) {
    const MaskCase c(random, linear);
    const auto v = random.uniform_vector(60, -1, 1);
    std::vector<double> g(60);
    c.loss(c.rendered, &g);
    CHECK(test::adjoint_difference(c.loss(test::seed(c.rendered, v)).d, test::dot(g, v)) < 1e-12);
    for (std::size_t i = 0; i < 60; ++i) CHECK((g[i] == 0) == (c.known[i / 3] == 0));
  }
}

TEST_CASE("loss_mask: the gradient agrees with extrapolated finite differences") {
  test::Random random(62);
  MaskCase c(random, false);
  for (double& p : c.rendered) p = clamp3(p, 0.1, 0.9);
  const auto v = random.uniform_vector(60, -1, 1);
  std::vector<double> g(60);
  c.loss(c.rendered, &g);
  const auto along = [&](double t) { return c.loss(test::moved(c.rendered, v, t)); };
  CHECK(test::ridders_difference(test::ridders(along, 0.05), test::dot(g, v)) < 1e-9);
}

}  // namespace ngs
