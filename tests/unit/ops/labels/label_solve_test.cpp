#include "ngs/ops/labels/label_solve.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/losses/loss_mask_kernels.h"
#include "support/method_case.h"
#include "support/random.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

LabelProblem problem_of(const test::MethodCase& c) {
  LabelProblem p{c.cloud, {}, [&c](std::size_t v) { return pixel_targets(c.masks[v], 0); }, {}};
  for (const SceneView& v : c.scene.views) p.cameras.push_back(v.camera);
  return p;
}

struct ReferenceSums {
  double loss = 0;
  std::vector<double> inside, outside;
  bool near_threshold = false;
};

/// The definition in label_system.h, evaluated in double with the weights of the reference renderer.
ReferenceSums reference_sums(const test::MethodCase& c, const std::vector<double>& m,
                             const std::vector<PixelTargets>& targets) {
  ReferenceSums s;
  s.inside.resize(m.size());
  s.outside.resize(m.size());
  double total = 0;
  for (std::size_t v = 0; v < c.view.size(); ++v) {
    const auto image = test::reference_render(c.view[v], {});
    for (std::size_t p = 0; p < image.size(); ++p) {
      s.near_threshold |= image[p].closest_threshold < 1e-5;
      double q = 0;
      for (const auto& [g, w] : image[p].weight) q += w * m[std::size_t(g)];
      const double fore = kMaskEps + (1 - 2 * kMaskEps) * q, back = 1 - fore;
      const double a = double(targets[v].inside[p]), b = double(targets[v].outside[p]);
      s.loss -= a * std::log(fore) + b * std::log(back);
      total += a + b;
      for (const auto& [g, w] : image[p].weight) {
        s.inside[std::size_t(g)] += w * a / fore;
        s.outside[std::size_t(g)] += w * b / back;
      }
    }
  }
  s.loss /= total;
  return s;
}

std::vector<std::int32_t> every(std::size_t n, std::size_t step) {
  std::vector<std::int32_t> column(n, -1);
  std::int32_t next = 0;
  for (std::size_t i = 0; i < n; i += step) column[i] = next++;
  return column;
}

std::vector<std::uint8_t> ones(std::size_t n) { return std::vector<std::uint8_t>(n, 1); }

/// Two Gaussians so wide that alpha is 0.5 at every pixel: the nearer has weight 0.5, the other 0.25. The
/// second camera looks from the other side. The masks contain the shares `share0` and `share1` of the pixels of
/// the two views.
struct TwoSheets {
  GaussianCloud cloud;
  std::vector<Camera> cameras;
  std::vector<PixelTargets> targets;

  TwoSheets(double share0, double share1) {
    for (const double z : {-1, 1}) test::add_gaussian(cloud, {0, 0, z}, {2e4, 2e4, 1e-3}, {}, 0);
    for (int v = 0; v < 2; ++v) {
      Camera camera{.name = {}, .width_px = 20, .height_px = 20, .fx = 20, .fy = 20, .cx = 10, .cy = 10};
      const double side = v == 0 ? 1 : -1;
      camera.rotation = {{side, 0, 0, 0, 1, 0, 0, 0, side}};
      camera.translation = {0, 0, 5};
      cameras.push_back(camera);
      const double share = v == 0 ? share0 : share1;
      PixelTargets t;
      for (int p = 0; p < 400; ++p) {
        t.inside.push_back(p < share * 400 ? 1.f : 0.f);
        t.outside.push_back(1 - t.inside.back());
      }
      targets.push_back(t);
    }
  }
  LabelProblem problem() const {
    return {cloud, cameras, [this](std::size_t v) { return targets[v]; }, {}};
  }
};

}  // namespace

TEST_CASE(
    "the label system evaluates loss and gradient sums as defined, for any folded labels and for soft "
    "targets") {
  int compared = 0;
  for (std::uint64_t seed = 20; seed < 26; ++seed) {
    CAPTURE(seed);
    const test::MethodCase c = test::method_case(seed, 70, 3);
    std::vector<PixelTargets> targets;
    for (const ViewMasks& mask : c.masks) targets.push_back(pixel_targets(mask, 0));
    test::Random random(seed);
    if (seed % 2)  // soft masks and pixel weights
      for (PixelTargets& t : targets)
        for (std::size_t p = 0; p < t.inside.size(); ++p) {
          t.inside[p] *= float(random.uniform(0, 2));
          t.outside[p] += t.inside[p] * 0.25f;
        }
    LabelProblem problem = problem_of(c);
    problem.load_targets = [&](std::size_t v) { return targets[v]; };
    const std::vector<double> m = random.uniform_vector(70, 0.02, 0.98);
    const ReferenceSums want = reference_sums(c, m, targets);
    if (want.near_threshold) continue;
    for (const std::size_t step : {std::size_t(1), std::size_t(3)}) {
      const std::vector<std::int32_t> column = every(70, step);
      const LabelSystem system({.threads = 2}, problem, column, m, 1 << 30);
      std::vector<double> at;
      for (std::size_t i = 0; i < 70; i += step) at.push_back(m[i]);
      LabelSums got;
      system.evaluate({}, at, got);
      CHECK(got.loss == doctest::Approx(want.loss).epsilon(2e-6));
      for (std::size_t i = 0; i < 70; i += step) {
        const auto k = std::size_t(column[i]);
        CHECK(got.inside[k] == doctest::Approx(want.inside[i]).epsilon(2e-5));
        CHECK(got.outside[k] == doctest::Approx(want.outside[i]).epsilon(2e-5));
        compared += want.inside[i] + want.outside[i] > 0;
      }
    }
  }
  CHECK(compared > 200);
}

TEST_CASE("a label system gives the same sums streamed, partly cached, and for any number of threads") {
  const test::MethodCase c = test::method_case(31, 150, 4);
  const LabelProblem problem = problem_of(c);
  const std::vector<double> m = test::Random(1).uniform_vector(150, 0, 1);
  const std::vector<std::int32_t> column = every(150, 1);
  const LabelSystem cached({}, problem, column, m, std::int64_t(1) << 30);
  LabelSums want;
  cached.evaluate({}, m, want);
  CHECK(cached.stats().streamed_views == 0);
  for (const std::int64_t share : {0, 40, 80}) {
    const LabelSystem other({.threads = 3}, problem, column, m, cached.stats().cached_bytes * share / 100);
    CHECK(other.stats().streamed_views == (share == 0 ? 4 : share == 40 ? 3 : 1));
    LabelSums got;
    other.evaluate({.threads = 2}, m, got);
    CHECK(got.inside == want.inside);
    CHECK(got.outside == want.outside);
    CHECK(got.loss == doctest::Approx(want.loss).epsilon(1e-14));
  }
}

// Between the two sheets lie 300 Gaussians in a corner of the tile. For most pixels, the first column is followed by
// the 302nd.
TEST_CASE("a cached label system equals the streamed one for columns far apart in the list of a tile") {
  TwoSheets sheets(0.5, 0.4);
  for (int i = 2; i < 302; ++i) test::add_gaussian(sheets.cloud, {-2.2, -2.2, i / 400.0 - 0.4}, 0.05, {}, -4);
  const LabelProblem problem = sheets.problem();
  const std::vector<double> m = test::Random(5).uniform_vector(302, 0, 1);
  const LabelSystem cached({}, problem, every(302, 1), m, 1 << 30), streamed({}, problem, every(302, 1), m, 0);
  const LabelSystem again = cached.reduced({}, every(302, 1), m, 1 << 30);
  LabelSums want, got, reduced;
  streamed.evaluate({}, m, want);
  cached.evaluate({}, m, got);
  again.evaluate({}, m, reduced);
  CHECK(want.inside[0] > 0);
  CHECK(want.inside[1] > 0);
  CHECK(want.inside[150] > 0);
  CHECK(got.inside == want.inside);
  CHECK(got.outside == want.outside);
  CHECK(reduced.inside == want.inside);
  CHECK(reduced.outside == want.outside);
  CHECK(got.loss == doctest::Approx(want.loss).epsilon(1e-14));
}

TEST_CASE("at_start of a label system without cache equals evaluate at the initial labels") {
  const test::MethodCase c = test::method_case(33, 90, 3);
  const LabelProblem problem = problem_of(c);
  const std::vector<double> m = test::Random(4).uniform_vector(90, 0, 1);
  const std::vector<std::int32_t> column = every(90, 3);
  const LabelSystem system({.threads = 2}, problem, column, m, 0);
  std::vector<double> at;
  for (std::size_t i = 0; i < 90; i += 3) at.push_back(m[i]);
  LabelSums want;
  system.evaluate({.threads = 1, .isa = base_isa()}, at, want);
  CHECK(system.at_start().loss == want.loss);
  CHECK(system.at_start().inside == want.inside);
  CHECK(system.at_start().outside == want.outside);
}

TEST_CASE("weights in half precision take less cache and the certificate still holds") {
  for (std::uint64_t seed = 80; seed < 83; ++seed) {
    const test::MethodCase c = test::method_case(seed, 120, 4);
    LabelProblem problem = problem_of(c);
    const std::vector<double> start = test::Random(seed).uniform_vector(120, 0.05, 0.95);
    const LabelSystem full({}, problem, every(120, 1), start, 1 << 30);
    problem.half_weights = true;
    const LabelSystem half({}, problem, every(120, 1), start, 1 << 30);
    CHECK(double(half.stats().cached_bytes) < 0.75 * double(full.stats().cached_bytes));
    LabelSums exact, rounded;
    full.evaluate({}, start, exact);
    half.evaluate({}, start, rounded);
    CHECK(rounded.loss != exact.loss);
    CHECK(rounded.loss == doctest::Approx(exact.loss).epsilon(1e-4));
    const LabelSolution solution = solve_labels({}, problem, {}, start, ones(120));
    CHECK(solution.converged);  // by the certificate, which uses full-precision weights
    CHECK(solution.gap <= 1e-3 * solution.loss);
  }
}

TEST_CASE("a reduced label system equals the full one with the other labels fixed") {
  const test::MethodCase c = test::method_case(32, 120, 3);
  const LabelProblem problem = problem_of(c);
  const std::vector<double> m = test::Random(2).uniform_vector(120, 0, 1);
  for (const std::int64_t bytes : {std::int64_t(0), std::int64_t(1) << 30}) {
    const LabelSystem full({}, problem, every(120, 1), m, bytes);
    const std::vector<std::int32_t> keep = every(120, 4);
    const LabelSystem reduced = full.reduced({}, keep, m, bytes);
    CHECK(reduced.columns() == 30);
    CHECK(reduced.gradient_scale() == full.gradient_scale());
    std::vector<double> at, moved = m;
    for (std::size_t i = 0; i < 120; i += 4) at.push_back(moved[i] = 1 - m[i]);
    LabelSums want, got;
    full.evaluate({}, moved, want);
    reduced.evaluate({}, at, got);
    CHECK(got.loss == doctest::Approx(want.loss).epsilon(1e-6));
    for (std::size_t i = 0; i < 120; i += 4) CHECK(got.inside[i / 4] == doctest::Approx(want.inside[i]).epsilon(1e-5));
  }
}

// If 0.5 m0 + 0.25 m1 = share0 and 0.25 m0 + 0.5 m1 = share1 have a solution in the box, both views are fitted exactly.
// Float sums leave a relative gap of about 1e-7. With a requested gap of 2e-6, the loss is within 2e-6 of its minimum.
// The curvature in every direction is above 0.3, so the labels are within sqrt(2 · 2e-6 · 0.7 / 0.3) = 3e-3.
TEST_CASE("solve_labels finds the analytic optimum of a problem of two Gaussians") {
  LabelSolveOptions options{.relative_gap = 2e-6, .stop = {}};
  const TwoSheets inside(0.5, 0.4);  // m = (0.8, 0.4)
  const LabelSolution a = solve_labels({}, inside.problem(), options, {0.5, 0.5}, ones(2));
  CHECK(a.converged);
  CHECK(a.label[0] == doctest::Approx(0.8).epsilon(3e-3));
  CHECK(a.label[1] == doctest::Approx(0.4).epsilon(3e-3));
  const double entropy = -(0.5 * std::log(0.5) + 0.5 * std::log(0.5) + 0.4 * std::log(0.4) + 0.6 * std::log(0.6)) / 2;
  CHECK(a.loss == doctest::Approx(entropy).epsilon(1e-5));

  // share0 = 0.6, share1 = 0: the second label is at its bound 0, and the first balances 0.5 m against 0.25 m:
  // 0.6/m - 0.4 · 0.5/(1 - 0.5 m) - 0.25/(1 - 0.25 m) = 0, solved by bisection.
  double lo = 0.1, hi = 1;
  for (int i = 0; i < 60; ++i) {
    const double m = (lo + hi) / 2;
    (0.6 / m - 0.2 / (1 - 0.5 * m) - 0.25 / (1 - 0.25 * m) > 0 ? lo : hi) = m;
  }
  const TwoSheets bound(0.6, 0.0);
  const LabelSolution b = solve_labels({}, bound.problem(), options, {0.5, 0.5}, ones(2));
  CHECK(b.converged);
  CHECK(b.label[0] == doctest::Approx(lo).epsilon(3e-3));
  CHECK(b.label[1] < 3e-3);
}

TEST_CASE("solve_labels keeps fixed labels, and moves labels that start at the wrong bound") {
  const TwoSheets sheets(0.5, 0.4);
  LabelSolveOptions options{.relative_gap = 2e-6, .stop = {}};
  const LabelSolution fixed = solve_labels({}, sheets.problem(), options, {0.25, 0.5}, {0, 1});
  CHECK(fixed.label[0] == 0.25);
  CHECK(fixed.columns == 1);
  CHECK(fixed.converged);
  const LabelSolution moved_off = solve_labels({}, sheets.problem(), options, {1.0, 0.0}, ones(2));
  CHECK(moved_off.columns == 2);
  CHECK(moved_off.converged);
  CHECK(moved_off.label[0] == doctest::Approx(0.8).epsilon(3e-3));
  const TwoSheets empty(0.0, 0.0);  // no pixel is in the mask: 0 is optimal
  const LabelSolution none = solve_labels({}, empty.problem(), options, {0.0, 0.0}, ones(2));
  CHECK(none.evaluations == 1);
  CHECK(none.working_columns == 0);
  CHECK(none.gap == 0);
  CHECK(none.converged);
}

TEST_CASE("an EM update never increases the loss") {
  for (std::uint64_t seed = 40; seed < 44; ++seed) {
    const test::MethodCase c = test::method_case(seed, 90, 3);
    const LabelProblem problem = problem_of(c);
    std::vector<double> m = test::Random(seed).uniform_vector(90, 0.01, 0.99);
    const LabelSystem system({}, problem, every(90, 1), m, 1 << 30);
    LabelSums sums;
    system.evaluate({}, m, sums);
    double before = sums.loss;
    for (int i = 0; i < 30; ++i) {
      m = em_update(m, sums);
      system.evaluate({}, m, sums);
      CHECK(sums.loss <= before * (1 + 1e-7));
      before = sums.loss;
    }
  }
}

TEST_CASE(
    "the Frank-Wolfe gap bounds the remaining gain at any labels, and the certificate equals the gap in "
    "double") {
  for (std::uint64_t seed = 50; seed < 54; ++seed) {
    CAPTURE(seed);
    const test::MethodCase c = test::method_case(seed, 120, 4);
    const LabelProblem problem = problem_of(c);
    test::Random random(seed);
    const std::vector<double> start = random.uniform_vector(120, 0.05, 0.95);
    LabelSolveOptions tight{.relative_gap = 1e-6, .max_evaluations = 20000, .stop = {}};
    const LabelSolution best = solve_labels({}, problem, tight, start, ones(120));
    CHECK(best.converged);
    const LabelSystem system({}, problem, every(120, 1), start, 1 << 30);
    LabelSums sums;
    for (int i = 0; i < 20; ++i) {  // random points, and points between these and the optimum
      std::vector<double> m = random.uniform_vector(120, 0, 1);
      if (i % 2)
        for (std::size_t k = 0; k < m.size(); ++k) m[k] = 0.99 * best.label[k] + 0.01 * m[k];
      system.evaluate({}, m, sums);
      CHECK(frank_wolfe_gap(m, sums, system.gradient_scale()) >= sums.loss - best.loss);
      CHECK(sums.loss >= best.loss - best.gap);
    }
    const LabelSolution usual = solve_labels({}, problem, {}, start, ones(120));
    CHECK(usual.converged);
    CHECK(usual.gap <= 1e-3 * usual.loss);
    CHECK(usual.loss - best.loss <= usual.gap);
    for (const GapPoint& p : usual.trace)
      if (p.certified) CHECK(p.gap >= p.loss - best.loss);

    std::vector<PixelTargets> targets;
    for (const ViewMasks& mask : c.masks) targets.push_back(pixel_targets(mask, 0));
    const ReferenceSums reference = reference_sums(c, usual.label, targets);
    if (reference.near_threshold) continue;
    const double gap =
        frank_wolfe_gap(usual.label, {reference.loss, reference.inside, reference.outside}, system.gradient_scale());
    CHECK(gap == doctest::Approx(usual.gap).epsilon(0.02));
  }
}

TEST_CASE("solve_labels stops at its evaluation budget with a certified partial result") {
  const test::MethodCase c = test::method_case(60, 120, 3);
  const LabelSolution s = solve_labels({}, problem_of(c), {.relative_gap = 1e-9, .max_evaluations = 6, .stop = {}},
                                       test::Random(3).uniform_vector(120, 0.05, 0.95), ones(120));
  CHECK_FALSE(s.converged);
  CHECK(s.evaluations <= 8);
  CHECK(s.trace.back().certified);
  CHECK(s.trace.back().loss < s.trace.front().loss);
}

}  // namespace ngs
