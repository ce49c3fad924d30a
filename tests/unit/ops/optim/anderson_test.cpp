#include "ngs/ops/optim/anderson.h"

#include <doctest/doctest.h>

namespace ngs {

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
