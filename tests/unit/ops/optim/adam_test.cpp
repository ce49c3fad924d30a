#include "ngs/ops/optim/adam.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "ngs/core/error.h"
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

TEST_CASE("adam_step in float moves by lr per step under a constant gradient for 1e5 steps") {
  // The bias correction cancels exactly for a constant gradient, so every step is -lr·sign(g). What remains is
  // rounding: v stalls within eps/(2(1-β₂)) = 3e-5 of g², m within 3e-7; while |x| < 1 its own rounding is below
  // 6e-8 per step of 1e-3. At |x| near 100 that rounding is 3.8e-6, always the same way: 3.8e-3 of a step at most.
  const Exec exec;
  const AdamOptions options{.lr = 1e-3};
  const std::vector<float> gradient{1e-9f, -3e-4f, 7.f, -1e9f};
  std::vector<float> x(4, 0.f);
  AdamMoments moments;
  double worst_step = 0;
  for (int t = 1; t <= 100000; ++t) {
    const std::vector<float> before = x;
    adam_step(exec, options, t, {"x", x, gradient}, moments);
    if (t < 1000)
      for (std::size_t i = 0; i < 4; ++i)
        worst_step = std::max(worst_step, std::abs(std::abs(double(x[i]) - before[i]) / 1e-3 - 1));
  }
  CHECK(worst_step < 1.5e-4);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(double(x[i]) == doctest::Approx(gradient[i] > 0 ? -100.0 : 100.0).epsilon(3.8e-3));
}

TEST_CASE("adam_step leaves values finite and unchanged under zero gradients") {
  const Exec exec;
  std::vector<float> x{1.f, -2.f, 0.f}, g(3, 0.f);
  AdamMoments moments;
  for (int t = 1; t <= 3; ++t) adam_step(exec, {}, t, {"x", x, g}, moments);
  CHECK(x == std::vector<float>{1.f, -2.f, 0.f});
}

TEST_CASE("adam_step stays finite for tiny gradients whose square underflows") {
  const Exec exec;
  std::vector<float> x{0.f, 0.f}, g{1e-30f, -1e-22f};  // g² is 0 in float
  AdamMoments moments;
  for (int t = 1; t <= 100; ++t) adam_step(exec, {}, t, {"x", x, g}, moments);
  for (const float value : x) CHECK(std::abs(value) < 1e-6f);
}

TEST_CASE("adam_step throws for a non-finite gradient, names its index and changes nothing") {
  const Exec exec{.threads = 2};
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1e30f}) {
    for (const std::size_t at : {std::size_t(0), std::size_t(40000), std::size_t(99999)}) {
      std::vector<float> x(100000, 1.f), g(100000, 0.5f);
      g[at] = bad;
      AdamMoments moments;
      try {
        adam_step(exec, {}, 1, {"position", x, g}, moments);
        FAIL("no error");
      } catch (const Error& e) {
        CHECK(e.code() == ErrorCode::kNumeric);
        CHECK(std::string(e.what()).find("position: gradient " + std::to_string(at) + " ") == 0);
      }
      CHECK(x == std::vector<float>(100000, 1.f));
    }
  }
}

TEST_CASE("sparse adam_step skips rows with zero gradient and steps the others like dense") {
  const Exec exec;
  std::vector<float> x(6, 1.f), dense_x(6, 1.f);
  const std::vector<float> g{0.f, 0.f, 1.f, 0.f, 0.f, 0.f};
  AdamMoments moments, dense_moments;
  moments.m.assign(6, 0.25f), moments.v.assign(6, 0.25f);
  dense_moments = moments;
  adam_step(exec, {.sparse_columns = 2}, 5, {"x", x, g}, moments);
  adam_step(exec, {}, 5, {"x", dense_x, g}, dense_moments);
  CHECK(x[0] == 1.f), CHECK(x[1] == 1.f), CHECK(x[4] == 1.f);
  CHECK(moments.m[0] == 0.25f), CHECK(moments.v[5] == 0.25f);
  CHECK(x[2] == dense_x[2]), CHECK(x[3] == dense_x[3]);
  CHECK(dense_x[0] < 1.f);  // dense keeps moving by momentum
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
