// Elementary functions at both ends of their range.
#include <doctest/doctest.h>

#include <bit>

#include "ngs/math/exact_sum.h"
#include "ngs/math/lanes.h"
#include "ngs/math/stable.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

float near_value(Random& random, double h) { return float(h * random.uniform(0.5, 1)); }

}  // namespace

HARD_CASE("elementary: 1 - e^-x keeps its relative accuracy for small x", "x", {100, 1, 1e-3, 1e-8, 1e-30}, 0.91,
          {"1 - exp(-x)", 4e6}) {
  const float x = near_value(random, h);
  worst.ours(one_minus_exp(x), -std::expm1(-Real(x)));
  worst.naive(1 - std::exp(-x), -std::expm1(-Real(x)));
}

HARD_CASE("elementary: the sigmoid neither overflows nor loses its small values", "-x", {1, 20, 60, 87, 100}, 2.5,
          {"1 / (1 + exp(-x)) as e^x / (1 + e^x)", test::kWrong}) {
  const float x = near_value(random, h);
  worst.ours(sigmoid(x), 1 / (1 + std::exp(-Real(x))));
  if (x < 86) worst.ours(sigmoid(-x), 1 / (1 + std::exp(Real(x))));
  worst.naive(std::exp(x) / (1 + std::exp(x)), 1 / (1 + std::exp(-Real(x))));
}

HARD_CASE("elementary: the sigmoid's slope does not vanish before float does", "|x|", {1, 10, 17, 40, 80}, 4,
          {"s (1 - s)", 4e6}) {
  const float x = near_value(random, random.uniform(0, 1) < 0.5 ? -h : h), s = sigmoid(x);
  const Real e = std::exp(-std::abs(Real(x))), want = e / ((1 + e) * (1 + e));
  worst.ours(sigmoid_slope(x), want);
  worst.naive(s * (1 - s), want);
}

HARD_CASE("elementary: softplus is linear above and exponential below", "|x|", {1, 10, 50, 85, 1e4, 1e30}, 1.6,
          {"log(1 + exp(x))", test::kWrong}) {
  const float x = near_value(random, h);
  const Real above = Real(x) + std::log1p(std::exp(-Real(x)));
  worst.ours(softplus(x), above);
  worst.naive(std::log(1 + std::exp(x)), above);
  if (x > 85) return;
  worst.ours(softplus(-x), std::log1p(std::exp(-Real(x))));
  worst.naive(std::log(1 + std::exp(-x)), std::log1p(std::exp(-Real(x))));
}

HARD_CASE("elementary: the logit is accurate near 0 and near 1", "distance to the end", {0.4, 1e-3, 1e-6, 1e-30}, 0.8,
          {"-log(1 / p - 1)", 1e4}) {
  const float p = near_value(random, h), q = 1 - float(near_value(random, h));
  for (const float x : {p, q}) {
    if (x >= 1) continue;
    const Real want = std::log(Real(x)) - std::log1p(-Real(x)),
               condition = 1 + (std::abs(std::log(Real(x))) + std::abs(std::log1p(-Real(x)))) / std::abs(want);
    worst.ours(logit(x), want, condition);
    worst.naive(-std::log(1 / x - 1), want, condition);
  }
}

HARD_CASE("elementary: 2^x of the compositing loop is within an ulp and the same in every lane", "-x",
          {0.1, 5, 30, 126}, 0.8, {"e^(x ln 2)", 10}) {
  float in[8], out[8];
  for (float& x : in) x = float(-h * random.uniform(0, 1));
  PackF x;
  load_lanes(in, x);
  store_lanes(out, exp2_where(all_lanes(x), x));
  for (int k = 0; k < 8; ++k) {
    const Real want = std::exp2(Real(in[k]));
    worst.ours(out[k], want);
    worst.ours_is(out[k] == exp2_where(true, in[k]));
    worst.naive(std::exp(in[k] * 0.693147181f), want);
  }
}

HARD_CASE("elementary: masked-out lanes of the compositing loop's 2^x are exactly zero for any input", "-x",
          {126, 150, 1e4, 1e30, INFINITY, NAN}, 0, {"the power times 0", test::kWrong}) {
  const float x = -near_value(random, h);
  for (const float any : {x, -x}) {
    float lane[8];
    store_lanes(lane, exp2_where(PackF(1) < PackF(0), PackF(any)));
    worst.ours_is(std::bit_cast<std::uint32_t>(lane[0]) == 0 &&
                  std::bit_cast<std::uint32_t>(exp2_where(false, any)) == 0);
  }
  worst.naive_is(std::exp2(-x) * 0 == 0);
}

HARD_CASE("elementary: a sum over 30 decades does not depend on its order", "terms", {2, 10, 1000}, 0,
          {"a sum in double", test::kWrong}) {
  std::vector<double> terms;
  for (int i = 0; i < int(h); ++i) terms.push_back(std::pow(10.0, random.uniform(-15, 15)));
  ExactSums sums[2];
  double naive[2] = {};
  for (int order = 0; order < 2; ++order) {
    sums[order].resize(1);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const double x = terms[order == 0 ? i : terms.size() - 1 - i];
      sums[order].add(0, x);
      naive[order] += x;
    }
  }
  worst.ours_is(sums[0].whole == sums[1].whole && sums[0].fraction == sums[1].fraction);
  worst.naive_is(naive[0] == naive[1]);
}

HARD_CASE("elementary: a sum over 30 decades keeps its small terms", "terms", {10, 1e3, 1e4}, 0.86,
          {"a sum in float", 20}) {
  ExactSums sum;
  sum.resize(1);
  Real want = 0;
  float naive = 0;
  for (int i = 0; i < int(h); ++i) {
    const double x = i == 0       ? 1e15
                     : i % 2 == 1 ? 1e15 / h * random.uniform(0.1, 1)
                                  : std::pow(10.0, random.uniform(-15, -10));
    sum.add(0, x);
    want += x;
    naive += float(x);
  }
  worst.ours(float(sum.value(0)), want);
  worst.naive(naive, want);
  Real small = 0;
  ExactSums tiny;
  tiny.resize(1);
  for (int i = 0; i < int(h); ++i) {
    const double x = std::pow(10.0, random.uniform(-11, -9));
    tiny.add(0, x);
    small += x;
  }
  worst.ours(float(tiny.value(0)), small);
}

HARD_CASE("elementary: a sum of many fractions carries into its whole part exactly", "terms", {1, 10, 1e3, 1e4}, 0,
          {"a sum in float", test::kWrong}, 2) {
  ExactSums sum;
  sum.resize(1);
  std::int64_t want = 0;  // in units of 2^-20
  float naive = 0;
  for (int i = 0; i < int(h); ++i) {
    const std::int64_t rest = random.below(1 << 20), term = (std::int64_t(1) << 36) + (h > 1 ? rest : 0);
    sum.add(0, double(term) * 0x1p-20);
    want += term;
    naive += float(double(term) * 0x1p-20);
  }
  worst.ours_is(sum.value(0) == double(want) * 0x1p-20);
  worst.naive_is(double(naive) == double(want) * 0x1p-20);
}

}  // namespace ngs
