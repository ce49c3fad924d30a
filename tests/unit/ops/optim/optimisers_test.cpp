#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "ngs/core/rng.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/ops/optim/anderson.h"

namespace ngs {
namespace {

// The textbook form, one scalar, in long double.
struct ScalarAdam {
  long double x, m = 0, v = 0;
  void step(long double g, int t, const AdamOptions& o) {
    m = o.beta1 * m + (1 - o.beta1) * g;
    v = o.beta2 * v + (1 - o.beta2) * g * g;
    const long double m_hat = m / (1 - std::pow((long double)o.beta1, t));
    const long double v_hat = v / (1 - std::pow((long double)o.beta2, t));
    x -= o.lr * m_hat / (std::sqrt(v_hat) + o.eps);
  }
};

}  // namespace

TEST_CASE("adam_step follows the textbook scalar recursion in double to rounding") {
  const Exec exec{.threads = 2};
  AdamOptions options{.lr = 0.03, .beta1 = 0.8, .beta2 = 0.95, .eps = 1e-8};
  for (const std::size_t n : {std::size_t(0), std::size_t(1), std::size_t(2), std::size_t(4095), std::size_t(4097)}) {
    std::vector<double> x(n), g(n), m(n, 0), v(n, 0);
    std::vector<ScalarAdam> want;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = rng_normal(1, RngStream::kTest, i);
      want.push_back({x[i]});
    }
    for (int t = 1; t <= 20; ++t) {
      for (std::size_t i = 0; i < n; ++i) {
        g[i] = rng_normal(std::uint64_t(t), RngStream::kTest, i);
        want[i].step(g[i], t, options);
      }
      adam_step(exec, options, t, {"x", x, g}, {m, v});
    }
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) worst = std::max(worst, std::abs(x[i] - double(want[i].x)));
    CHECK(worst < 1e-13);  // 20 steps of a few eps each on values of order 1
  }
}

TEST_CASE("adam_step gives the same bytes for any thread count") {
  const auto result = [](int threads) {
    std::vector<float> x(10007), g(10007);
    for (std::size_t i = 0; i < x.size(); ++i) g[i] = float(rng_normal(3, RngStream::kTest, i));
    AdamMoments moments;
    for (int t = 1; t <= 5; ++t) adam_step({.threads = threads}, {}, t, {"x", x, g}, moments);
    return x;
  };
  for (const int threads : {2, 3}) CHECK(result(threads) == result(1));
}

TEST_CASE("Anderson acceleration solves a linear iteration of n unknowns in n + 1 steps") {
  // x <- A x + b with A = diag(0.9, 0.5, -0.3), fixed point b / (1 - a)
  const std::vector<double> a{0.9, 0.5, -0.3}, b{1, 2, -1}, ones(3, 1.0);
  std::vector<double> x(3, 0.0), f(3);
  Anderson history(3);
  for (int step = 0; step < 4; ++step) {
    for (std::size_t i = 0; i < 3; ++i) f[i] = (a[i] - 1) * x[i] + b[i];
    x = history.next(x, f, ones);
    if (step == 0) CHECK(x == b);  // without a history: the plain step
  }
  for (std::size_t i = 0; i < 3; ++i) CHECK(x[i] == doctest::Approx(b[i] / (1 - a[i])).epsilon(1e-8));
}

TEST_CASE("Anderson acceleration ignores components of weight 0 and stays finite for equal points") {
  Anderson history(2);
  const std::vector<double> weight{1, 0};
  std::vector<double> x{0, 0};
  for (int step = 0; step < 3; ++step) x = history.next(x, {0.5 * (1 - x[0]), step % 2 == 0 ? 1e300 : -1e300}, weight);
  CHECK(x[0] == doctest::Approx(1).epsilon(1e-12));
  Anderson still(2);
  for (int step = 0; step < 4; ++step) CHECK(still.next({3, 4}, {0, 0}, {1, 1}) == std::vector<double>{3, 4});
}

}  // namespace ngs
