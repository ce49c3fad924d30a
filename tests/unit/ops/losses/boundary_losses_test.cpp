#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/field/sample_grid.h"
#include "ngs/ops/losses/loss_align.h"
#include "ngs/ops/losses/loss_cont.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/losses/loss_smooth.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/random.h"

namespace ngs {
namespace {

Exec threads(int n) { return {.threads = n}; }

ImageF random_image(test::Random& random, int width, int height, int channels) {
  ImageF image(width, height, channels);
  image.data = random.uniform_vector<float>(image.data.size(), 0, 1);
  return image;
}

/// A view of 40 x 30 px with a grid over its middle.
struct AlignScene {
  PixelGrid grid = pixel_grid({5, 4, 33, 27}, 6, 8);
  ImageF colour, alpha;
  std::vector<float> field_colour, field_alpha;
  explicit AlignScene(std::uint64_t seed) {
    test::Random random(seed);
    colour = random_image(random, 40, 30, 3);
    alpha = random_image(random, 40, 30, 1);
    field_colour = random.uniform_vector<float>(144, 0, 1);
    field_alpha = random.uniform_vector<float>(48, 0, 1);
  }
  AlignInputs inputs() const { return {grid, &colour, &alpha, &field_colour, &field_alpha, nullptr}; }
};

ViewMasks masks_of(int width, int height, std::vector<std::vector<float>> target) {
  return {.width_px = width, .height_px = height, .target = std::move(target), .known = {}, .available = true};
}

}  // namespace

TEST_CASE("loss_align: a constant view and an equal field agree exactly") {
  AlignScene s(1);
  s.colour = ImageF(40, 30, 3, 0.25f);
  s.alpha = ImageF(40, 30, 1, 0.5f);
  s.field_colour.assign(144, 0.25f);
  s.field_alpha.assign(48, 0.5f);
  AlignContext context;
  const AlignLoss loss = loss_align({}, {}, s.inputs(), context);
  CHECK(loss.total == 0);
  CHECK(loss.nodes == 48);
}

TEST_CASE("loss_align: the parts have the values of the formula") {
  AlignScene s(1);
  s.colour = ImageF(40, 30, 3, 0.25f);
  s.alpha = ImageF(40, 30, 1, 0.5f);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) s.colour.at(x, y, 0) = x % 2 == 0 ? 0.2f : 0.4f;  // patches of 7: 3 or 4 of each
  s.field_colour.assign(144, 0.25f);
  s.field_alpha.assign(48, 0.1f);
  AlignContext context;
  const AlignLoss loss = loss_align({}, {.weight_alpha = 0.5, .weight_variance = 2}, s.inputs(), context);
  CHECK(loss.alpha == doctest::Approx(0.16).epsilon(1e-5));
  CHECK(loss.variance == doctest::Approx(0.04 * 12 / 49).epsilon(1e-5));
  CHECK(loss.total == doctest::Approx(loss.colour + 0.5 * loss.alpha + 2 * loss.variance));
}

TEST_CASE("density weights are sigmoids of the interpolated optical depth inside the box and 0.5 outside") {
  const PixelBox box{2, 1, 6, 5};
  const PixelGrid grid = pixel_grid(box, 2, 2);  // nodes at x 3, 5 and y 2, 4
  ImageF w(8, 6, 1), even(3, 2, 1);
  density_weights({}, {grid, box, {0, 4, 0, 4}}, w);
  CHECK(w.at(0, 0) == 0.5f);
  CHECK(w.at(7, 3) == 0.5f);
  CHECK(w.at(2, 2) == 0.5f);                                               // x 2.5: left of the first node, D = 0
  CHECK(double(w.at(3, 2)) == doctest::Approx(1 / (1 + std::exp(-1.0))));  // x 3.5: a quarter of the way
  CHECK(double(w.at(5, 3)) == doctest::Approx(1 / (1 + std::exp(-4.0))));
  density_weights({}, {{}, {}, {}}, even);
  CHECK(even.data == std::vector<float>(6, 0.5f));
}

TEST_CASE("loss_mask: unknown pixels, missing masks and zero view_weight give no gradient") {
  test::Random random(7);
  const ImageF p = random_image(random, 6, 5, 2);
  ViewMasks masks = masks_of(6, 5, {std::vector<float>(30, 1.f), std::vector<float>(30, 0.f)});
  ImageF g;
  masks.known.assign(30, 1);
  masks.known[4] = 0;
  const MaskLoss loss = loss_mask({}, {}, {&p, &masks, nullptr, 1}, 1, &g);
  CHECK(loss.known == 29);
  CHECK(g.at(4, 0, 0) == 0);
  CHECK(g.at(4, 0, 1) == 0);
  CHECK(g.at(5, 0, 0) != 0);
  CHECK(loss_mask({}, {}, {&p, &masks, nullptr, 0.5}, 1, nullptr).total == doctest::Approx(loss.total / 2));
  masks.known.assign(30, 0);
  CHECK(loss_mask({}, {}, {&p, &masks, nullptr, 1}, 1, &g).total == 0);
  masks.available = false;
  CHECK(loss_mask({}, {}, {&p, &masks, nullptr, 1}, 1, &g).total == 0);
  CHECK(g.data == std::vector<float>(60, 0.f));
}

TEST_CASE("loss_mask: the literal reading of the paper is the linear loss times ln(1/eps)") {
  // Eq. as printed with binary truth G inside the logarithms (eps added), prediction outside (C18).
  test::Random random(8);
  const ImageF p = random_image(random, 8, 8, 1);
  std::vector<float> truth = random.uniform_vector<float>(64, 0, 1);
  double printed = 0, ones = 0;
  constexpr double kEps = 1e-6;
  for (std::size_t i = 0; i < 64; ++i) {
    truth[i] = truth[i] > 0.5f ? 1.f : 0.f;
    const double m = double(p.data[i]), g = double(truth[i]);
    printed += -m * std::log(g + kEps) - (1 - m) * std::log(1 - g + kEps);
    ones += g;
  }
  const ViewMasks masks = masks_of(8, 8, {truth});
  const double linear = loss_mask({}, {MaskLossForm::kLinear, 1}, {&p, &masks, nullptr, 1}, 1, nullptr).total;
  CHECK(printed / 64 == doctest::Approx(-std::log(kEps) * (linear + ones / 64)).epsilon(1e-5));
}

TEST_CASE("loss_mask gives the same bytes for 1 and 7 threads") {
  test::Random random(9);
  const ImageF p = random_image(random, 50, 40, 3);
  const ViewMasks masks = masks_of(
      50, 40, {std::vector<float>(2000, 1.f), std::vector<float>(2000, 0.f), random.uniform_vector<float>(2000, 0, 1)});
  const ImageF weight = random_image(random, 50, 40, 1);
  ImageF a, b;
  CHECK(loss_mask(threads(1), {}, {&p, &masks, &weight, 1}, 1, &a).total ==
        loss_mask(threads(7), {}, {&p, &masks, &weight, 1}, 1, &b).total);
  CHECK(a.data == b.data);
}

TEST_CASE("loss_cont: the loss of constant colours is 0, the loss of one step is its square") {
  const std::vector<float> points{0, 0, 0, 1, 0, 0, 2.5f, 0, 0};
  const KnnGraph graph = nearest_others({}, {points.data(), 3}, 1);  // 0 -> 1, 1 -> 0, 2 -> 1
  const std::vector<float> same(9, 0.4f), step{0, 0, 0, 0.5f, 0, 0, 0.5f, 0, 0};
  std::vector<float> g;
  CHECK(loss_cont({}, {graph, {same.data(), 3}}, 1, &g) == 0);
  CHECK(g == std::vector<float>(9, 0.f));
  CHECK(loss_cont({}, {graph, {step.data(), 3}}, 1, &g) == doctest::Approx(2 * 0.25 / 3));
  CHECK(double(g[0]) == doctest::Approx(-2.0 * 2 * 0.5 / 3));
  CHECK(g[6] == 0);
  const KnnGraph lonely = nearest_others({}, {points.data(), 1}, 1);
  CHECK(loss_cont({}, {lonely, {step.data(), 1}}, 1, &g) == 0);
}

TEST_CASE("loss_cont gives the same bytes for 1 and 7 threads") {
  test::Random random(10);
  const auto points = random.uniform_vector<float>(3000, -1, 1), colour = random.uniform_vector<float>(3000, 0, 1);
  const KnnGraph graph = nearest_others({}, {points.data(), 1000}, 8);
  std::vector<float> a, b;
  CHECK(loss_cont(threads(1), {graph, {colour.data(), 1000}}, 1, &a) ==
        loss_cont(threads(7), {graph, {colour.data(), 1000}}, 1, &b));
  CHECK(a == b);
}

TEST_CASE("loss_smooth: random pairs lie on spheres, differ between steps and repeat with the seed") {
  const std::vector<float> points(3000, 0.5f);
  const Rows<const float, 3> rows{points.data(), 1000};
  const auto pairs = [&](int workers, std::uint64_t first) {
    return smoothness_pairs(threads(workers), rows, 0.25, {1, first});
  };
  const SmoothnessPairs a = pairs(1, 0);
  CHECK(a.from == points);
  CHECK(a.length == 0.25);
  CHECK(a.to == pairs(7, 0).to);
  CHECK(pairs(1, 1000).to != a.to);
  double mean[3] = {0, 0, 0};
  for (std::size_t i = 0; i < 1000; ++i) {
    double d2 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      d2 += std::pow(double(a.to[i * 3 + c]) - 0.5, 2);
      mean[c] += (double(a.to[i * 3 + c]) - 0.5) / 1000;
    }
    CHECK(std::sqrt(d2) == doctest::Approx(0.25).epsilon(1e-5));
  }
  for (const double m : mean) CHECK(std::abs(m) < 0.02);  // 4 standard deviations of the mean of 1000: 0.018
}

namespace {

/// L_smth at `points` of colours that depend on the position alone.
template <class Colour>
double smoothness_of(const std::vector<float>& points, double h, double unit, const Colour& colour) {
  const Rows<const float, 3> rows{points.data(), std::int64_t(points.size() / 3)};
  const SmoothnessPairs pairs = smoothness_pairs({}, rows, h, {5, 0});
  const auto colours = [&](const std::vector<float>& at) {
    std::vector<float> values(at.size());
    for (std::size_t i = 0; i < at.size(); i += 3)
      for (std::size_t c = 0; c < 3; ++c) values[i + c] = float(colour(&at[i], c));
    return values;
  };
  SmoothnessGradients g;
  return loss_smooth_backward({}, {pairs.length, unit}, {colours(pairs.from), colours(pairs.to)}, 1, g);
}

}  // namespace

TEST_CASE("loss_smooth: for a linear field the loss is an unbiased estimate of the squared gradient") {
  // c(x) = g·x in every channel with |g| = 3: Σ_channels |u ∇c|² = 3 · (2 · 3)² = 108 for u = 2.
  const auto linear = [](const float* x, std::size_t) { return x[0] + 2 * x[1] - 2 * x[2]; };
  const std::vector<float> points(60000, 0.f);
  // relative standard deviation 0.9 / sqrt(20000) = 0.6 %
  CHECK(smoothness_of(points, 0.1, 2, linear) == doctest::Approx(108).epsilon(0.03));
  SmoothnessGradients g;
  CHECK(loss_smooth_backward({}, {}, {{}, {}}, 1, g) == 0);
}

}  // namespace ngs
