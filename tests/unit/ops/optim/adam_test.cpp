#include "ngs/ops/optim/adam.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "ngs/core/rng.h"

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
    for (std::size_t i = 0; i < n; ++i) x[i] = rng_normal(1, RngStream::kTest, i), want.push_back({x[i]});
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
  std::vector<std::vector<float>> results;
  for (const int threads : {1, 2, 3}) {
    std::vector<float> x(10007), g(10007);
    for (std::size_t i = 0; i < x.size(); ++i) g[i] = float(rng_normal(3, RngStream::kTest, i));
    AdamMoments moments;
    for (int t = 1; t <= 5; ++t) adam_step({.threads = threads}, {}, t, {"x", x, g}, moments);
    results.push_back(x);
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}

}  // namespace ngs
