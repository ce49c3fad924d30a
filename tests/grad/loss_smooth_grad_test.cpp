#include <doctest/doctest.h>

#include "ngs/ops/losses/loss_smooth_kernels.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

template <class T>
T smoothness(const std::vector<T>& a, const std::vector<T>& b, std::vector<T>& grad_a, std::vector<T>& grad_b) {
  const std::int64_t n = std::int64_t(a.size() / 3);
  std::vector<T> term(a.size() / 3, T(0));
  grad_a.resize(a.size());
  grad_b.resize(a.size());
  const SmoothnessForwardBackward<T> kernel{{a.data(), n}, {b.data(), n},      T(0.8),
                                            term.data(),   {grad_a.data(), n}, {grad_b.data(), n}};
  T sum(0);
  for (std::int64_t i = 0; i < n; ++i) {
    kernel(i);
    sum += term[std::size_t(i)];
  }
  return T(0.8) * sum;
}

}  // namespace

TEST_CASE("loss_smooth: the gradients of both colours equal the adjoint of the loss") {
  test::Random random(81);
  for (const std::size_t n : {1u, 2u, 50u}) {
    const auto a = random.uniform_vector(n * 3, 0, 1), b = random.uniform_vector(n * 3, 0, 1);
    const auto va = random.uniform_vector(n * 3, -1, 1), vb = random.uniform_vector(n * 3, -1, 1);
    std::vector<double> ga, gb;
    smoothness(a, b, ga, gb);
    std::vector<test::DualD> unused_a, unused_b;
    const test::DualD loss = smoothness(test::seed(a, va), test::seed(b, vb), unused_a, unused_b);
    CHECK(test::adjoint_difference(loss.d, test::dot(ga, va) + test::dot(gb, vb)) < 1e-12);
  }
}

TEST_CASE("loss_smooth: the gradient agrees with extrapolated finite differences") {
  test::Random random(82);
  const auto a = random.uniform_vector(30, 0, 1), b = random.uniform_vector(30, 0, 1),
             v = random.uniform_vector(30, -1, 1);
  std::vector<double> ga, gb, unused_a, unused_b;
  smoothness(a, b, ga, gb);
  const auto along = [&](double t) { return smoothness(test::moved(a, v, t), b, unused_a, unused_b); };
  CHECK(test::ridders_difference(test::ridders(along, 0.1), test::dot(ga, v)) < 1e-10);
}

}  // namespace ngs
