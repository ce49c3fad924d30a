// Adam, and the convex label solve at its bounds.
#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "ngs/ops/labels/label_solve.h"
#include "ngs/ops/optim/adam.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

constexpr double kLr = 1e-2;

/// Step number t of one parameter at 0 with zero moments.
float first_move(float g, std::int64_t t) {
  std::vector<float> x{0.f}, grad{g};
  AdamMoments moments;
  adam_step({}, {.lr = kLr}, t, {"x", x, grad}, moments);
  return x[0];
}

}  // namespace

HARD_CASE("adam: without gradients parameters do not change", "gradient", {1, 1e-9, 0}, 0,
          {"m / sqrt(v)", test::kWrong}) {
  const std::vector<float> before = random.uniform_vector<float>(5, -1, 1), grad(5, float(h));
  const auto moved_by = [&](const std::vector<float>& x, double move) {
    bool fine = true;
    for (std::size_t i = 0; i < x.size(); ++i) fine &= std::abs(x[i] - (before[i] + float(move))) <= 1e-6f;
    return fine && (move != 0 || x == before);
  };
  for (const std::int64_t last : {1, 10, 1000}) {
    if (last > 10 && h > 0) continue;  // the accumulated rounding of x is not tested here
    std::vector<float> x = before, naive = before;
    AdamMoments moments;
    const std::int64_t first = h > 0 ? 1 : std::max<std::int64_t>(1, last - 3);
    const double move = h > 0 ? -kLr * double(last) : 0;
    float m = 0, v = 0;
    for (std::int64_t t = first; t <= last; ++t) {
      adam_step({}, {.lr = kLr, .eps = 0x1p-60}, t, {"x", x, grad}, moments);
      m = 0.9f * m + 0.1f * grad[0];
      v = 0.999f * v + 0.001f * grad[0] * grad[0];
      const double c1 = 1 - std::pow(0.9, double(t)), c2 = 1 - std::pow(0.999, double(t));
      for (float& value : naive) value -= float(kLr) * (m / float(c1)) / std::sqrt(v / float(c2));
    }
    worst.ours_is(moved_by(x, move));
    worst.naive_is(moved_by(naive, move));
  }
}

HARD_CASE("adam: the first move is the learning rate, whatever the size of the gradient", "-log10 |g|",
          {0, 5, 10, 15, 18}, 3.4, {"eps = 1e-8 outside the root", 4e6}) {
  const float g = float(std::pow(10.0, -h) * random.uniform(0.5, 1) * (random.below(2) ? 1 : -1));
  const Real v = std::sqrt(Real(0.001L) * g * g);  // below 1e-19 the square is no normal number of float
  const Real want = -kLr * Real(g) / (v / std::sqrt(Real(0.001L)) + 1e-15L);
  if (h <= 17)
    worst.ours(first_move(g, 1), want, h > 14 ? 4 : 1);
  else
    worst.ours_is(std::abs(first_move(g, 1)) <= float(kLr));
  worst.naive(-float(kLr) * g / (std::abs(g) + 1e-8f), want);
}

HARD_CASE("adam: bias corrections keep their accuracy at any step", "step", {1e5, 1e3, 100, 10, 2}, 3.8,
          {"1 - β^t in float", 20}) {
  const float g = float(random.uniform(0.1, 1));
  const auto t = std::int64_t(h);
  const Real c1 = -std::expm1(Real(t) * std::log(0.9L)), c2 = -std::expm1(Real(t) * std::log(0.999L));
  const Real want = -kLr / c1 * 0.1L * g / (std::sqrt(0.001L * g * g) / std::sqrt(c2) + 1e-15L);
  worst.ours(first_move(g, t), want);
  const float b1 = 0.9f, b2 = 0.999f, m = (1 - b1) * g, v = (1 - b2) * g * g;
  worst.naive(-float(kLr) * (m / (1 - std::pow(b1, float(t)))) / (std::sqrt(v / (1 - std::pow(b2, float(t)))) + 1e-15f),
              want);
}

HARD_CASE("adam: moments of a constant gradient are exact after a hundred thousand steps", "steps", {10, 1e3, 1e5},
          0.87, "not applicable: β m + (1 - β) g stalls within the same 1 / (1 - β) ulps", 1000) {
  const std::vector<float> grad = random.uniform_vector<float>(1000, 0.1, 1);
  std::vector<float> x(1000, 0.f);
  AdamMoments moments;
  for (std::int64_t t = 1; t <= std::int64_t(h); ++t) adam_step({}, {.lr = 1e-4}, t, {"x", x, grad}, moments);
  const Real c1 = -std::expm1(Real(h) * std::log(0.9L)), c2 = -std::expm1(Real(h) * std::log(0.999L));
  for (std::size_t i = 0; i < grad.size(); ++i) {
    worst.ours(moments.m[i], c1 * grad[i], 10);
    worst.ours(moments.v[i], c2 * grad[i] * grad[i], 1000);
    worst.ours(x[i], -1e-4L * h, 2 * h);
  }
}

HARD_CASE("adam: a NaN gradient is reported by name and changes nothing", "gradient", {1, 1e20, 3e38, INFINITY, NAN}, 0,
          {"a step with whatever came", test::kWrong}) {
  std::vector<float> x = random.uniform_vector<float>(100, -1, 1), grad = random.uniform_vector<float>(100, -1, 1);
  AdamMoments moments;
  adam_step({}, {.lr = kLr}, 1, {"position", x, grad}, moments);
  const std::vector<float> before = x, m = moments.m, v = moments.v;
  const auto at = std::size_t(random.below(100));
  grad[at] = random.below(2) == 1 ? float(h) : -float(h);
  bool named = false;
  try {
    adam_step({}, {.lr = kLr}, 2, {"position", x, grad}, moments);
  } catch (const Error& e) {
    named = e.code() == ErrorCode::kNumeric &&
            std::string(e.what()).find("position: gradient " + std::to_string(at) + " ") != std::string::npos;
  }
  const bool untouched = x == before && moments.m == m && moments.v == v;
  worst.ours_is(h == 1 ? !named && std::isfinite(x[at]) && !untouched : named && untouched);
  const float m1 = 0.9f * m[at] + 0.1f * grad[at], v1 = 0.999f * v[at] + 0.001f * grad[at] * grad[at];
  worst.naive_is(std::isfinite(before[at] - float(kLr) * m1 / std::sqrt(v1)) && std::isfinite(v1));
}

HARD_CASE("adam: rows without a gradient keep value and moments, the other rows step normally",
          "rows without a gradient", {0, 1, 9}, 0, {"a step of all rows alike", test::kWrong}) {
  constexpr std::size_t kRows = 10;
  const std::size_t columns = std::size_t(1) << random.below(4), still = std::size_t(h) * columns;
  std::vector<float> x = random.uniform_vector<float>(kRows * columns, -1, 1),
                     grad = random.uniform_vector<float>(kRows * columns, 0.1, 1);
  AdamMoments moments;
  adam_step({}, {.lr = kLr}, 1, {"table", x, grad}, moments);
  std::fill_n(grad.begin(), still, 0.f);
  std::vector<float> dense = x, sparse = x;
  AdamMoments dense_moments = moments, sparse_moments = moments;
  adam_step({}, {.lr = kLr}, 2, {"table", dense, grad}, dense_moments);
  adam_step({}, {.lr = kLr, .sparse_columns = int(columns)}, 2, {"table", sparse, grad}, sparse_moments);
  const auto as_wanted = [&](const std::vector<float>& value, const AdamMoments& after) {
    bool fine = true;
    for (std::size_t i = 0; i < x.size(); ++i)
      fine &= i < still ? value[i] == x[i] && after.m[i] == moments.m[i] && after.v[i] == moments.v[i]
                        : value[i] == dense[i] && after.m[i] == dense_moments.m[i];
    return fine;
  };
  worst.ours_is(as_wanted(sparse, sparse_moments));
  worst.naive_is(as_wanted(dense, dense_moments));
}

HARD_CASE("label solve: labels at saturation neither leave [0, 1] nor become NaN", "-log10 of the evidence",
          {0, 10, 100, 300, 400}, 0, {"P m / (P m + Q (1 - m)), in double", test::kWrong}) {
  const std::vector<double> m{random.uniform(0, 1), 1e-300, 1 - 1e-16, 0, 1, 0.5};
  const double p = std::pow(10.0, h / 2), q = std::pow(10.0, -h / 2), rest = std::pow(10.0, -h);
  LabelSums sums;  // P / Q up to 10^400; the last label has next to no evidence, at last none
  sums.inside = {p, q, q, p, p, rest};
  sums.outside = {q, p, p, q, q, rest};
  const auto as_wanted = [](const std::vector<double>& next) {
    bool fine = next[3] == 0 && next[4] == 1 && next[5] == 0.5;
    for (const double x : next) fine &= x >= 0 && x <= 1;
    return fine;
  };
  worst.ours_is(as_wanted(em_update(m, sums)) && frank_wolfe_gap(m, sums, 1e-3) >= 0);
  std::vector<double> printed;
  for (std::size_t i = 0; i < m.size(); ++i)
    printed.push_back(sums.inside[i] * m[i] / (sums.inside[i] * m[i] + sums.outside[i] * (1 - m[i])));
  worst.naive_is(as_wanted(printed));
}

HARD_CASE("label solve: the EM update keeps the accuracy of extreme odds", "-log10 of m", {1, 5, 12, 15}, 3.5,
          {"1 - m P / (m P + (1 - m) Q) for what is left", 1e15}) {
  const double m = std::pow(10.0, -h) * random.uniform(0.5, 1), p = random.uniform(0.5, 2), q = random.uniform(0.5, 2);
  LabelSums sums{.inside = {p}, .outside = {q}};
  const Real want = m * Real(p) / (m * Real(p) + (1 - Real(m)) * q);
  worst.ours(em_update({m}, sums)[0], want);
  const double rest = (1 - m) * q / (m * p + (1 - m) * q);
  worst.naive(1 - rest, want);
}

}  // namespace ngs
