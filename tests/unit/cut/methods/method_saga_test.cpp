#include "ngs/cut/methods/method_saga.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/neighbours/knn.h"
#include "support/method_case.h"
#include "support/random.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

struct SmoothCase {
  KnnGraph graph;
  std::vector<double> features, upstream;
  std::vector<std::uint8_t> used{1, 0, 1, 1};

  SmoothCase() {
    test::Random random(5);
    const std::vector<float> points = random.uniform_vector<float>(30 * 3, -1, 1);
    graph = nearest_points({}, {points.data(), 30}, {points.data(), 30}, 4);
    build_transpose(graph);
    features = random.uniform_vector(30 * 3, -1, 1);
    upstream = random.uniform_vector(30 * 3, -1, 1);
  }
  double value(const std::vector<double>& f) const {
    SmoothedFeatures<double> smooth(graph, 3);
    std::vector<double> u;
    smooth.forward({}, f, used, u);
    double sum = 0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += u[i] * upstream[i];
    return sum;
  }
};

/// Two distant clusters; the masks cover one of them.
test::MethodCase two_clusters() {
  test::MethodCase c = test::method_case(90, 0, 3);
  const Camera camera = c.scene.views[0].camera;
  test::Random random(7);
  const int n = 160;
  c.cloud = {};
  for (std::size_t i = 0; i < std::size_t(n); ++i) {
    const double side = i % 2 ? 0.25 : -0.2, z = random.uniform(2.8, 3.2);
    const Vec3<double> t{(side + random.uniform(-0.12, 0.12)) * z, random.uniform(-0.12, 0.12) * z, z};
    const Vec3<double> p = camera.centre() + transpose(camera.rotation) * t;
    test::add_gaussian(c.cloud, p, 0.06, {}, 1);
  }
  for (std::size_t v = 0; v < 3; ++v) {
    c.scene.views[v].camera = camera;
    c.scene.views[v].camera.fx *= 1 + 0.05 * double(v);
    ViewMasks& m = c.masks[v];
    for (int y = 0; y < m.height_px; ++y)
      for (int x = 0; x < m.width_px; ++x)
        m.target[0][std::size_t(y) * std::size_t(m.width_px) + std::size_t(x)] =
            float(x + 0.5 > camera.cx + 0.025 * camera.fx);
  }
  return c;
}

}  // namespace

// Central differences in double with step 1e-6: truncation 1e-12, cancellation 1e-10.
TEST_CASE("the gradient of smoothed affinity features equals finite differences, dropped neighbours included") {
  const SmoothCase c;
  SmoothedFeatures<double> smooth(c.graph, 3);
  std::vector<double> u, grad;
  smooth.forward({}, c.features, c.used, u);
  smooth.backward({.threads = 2}, c.features, u, c.upstream, grad);
  for (std::size_t i = 0; i < c.features.size(); ++i) {
    std::vector<double> lo = c.features, hi = c.features;
    lo[i] -= 1e-6;
    hi[i] += 1e-6;
    CHECK(std::abs((c.value(hi) - c.value(lo)) / 2e-6 - grad[i]) < 1e-8);
  }
  for (std::size_t i = 0; i < 30; ++i) CHECK(std::hypot(u[i * 3], u[i * 3 + 1], u[i * 3 + 2]) == doctest::Approx(1));
}

TEST_CASE("the contrastive loss of three pixels equals its formula") {
  // objects 1, 1 at right angles, background along the first: same pair cos 0, different pairs cos 1 and 0.
  const std::vector<float> features = {2, 0, 0, 1, 3, 0};
  const std::vector<int> id = {1, 1, 0};
  std::vector<float> grad;
  CHECK(contrastive_loss({}, 2, features, id, grad) == doctest::Approx(0.0 + 0.5 + 1.0));  // mean length 2
  CHECK(grad[1] == doctest::Approx(-1.0 / 2));  // towards the other object pixel, divided by its own length
}

// float inputs and outputs: central differences with step 1e-2 leave truncation of 1e-4.
TEST_CASE("the gradient of the contrastive loss equals finite differences, with background and short features") {
  test::Random random(9);
  std::vector<float> features = random.uniform_vector<float>(24 * 4, -1, 1);
  std::vector<int> id;
  for (int i = 0; i < 24; ++i) id.push_back(int(random.below(3)));
  for (std::size_t c = 0; c < 4; ++c) features[4 * 4 + c] *= 1e-5f;
  std::vector<float> grad, ignored;
  contrastive_loss({.threads = 2}, 4, features, id, grad);
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (i / 4 == 4) continue;
    std::vector<float> lo = features, hi = features;
    lo[i] -= 1e-2f;
    hi[i] += 1e-2f;
    const double numeric = (contrastive_loss({}, 4, hi, id, ignored) - contrastive_loss({}, 4, lo, id, ignored)) /
                           (double(hi[i]) - double(lo[i]));
    CHECK(std::abs(numeric - double(grad[i])) < 1e-3);
  }
}

TEST_CASE("saga separates two clusters if the masks cover one of them") {
  const test::MethodCase c = two_clusters();
  SagaOptions options{.dims = 8, .steps = 120, .pixels = 128, .lr = 0.02, .image_scale = 1};
  const Solution r = run_saga({}, test::Quiet(), options, c.input());
  int right = 0, seen = 0;
  for (std::size_t i = 0; i < r.labels[0].label.size(); ++i) {
    if (r.labels[0].views[i] == 0) continue;
    ++seen;
    right += r.labels[0].label[i] == float(i % 2);
  }
  CHECK(seen > 100);
  CHECK(right >= seen * 95 / 100);
  CHECK(r.figures.at("loss") < -0.5);
}

TEST_CASE("saga fails for a scene without training views, and skips views without masks") {
  test::MethodCase c = test::method_case(91, 30, 2);
  SagaOptions options{.steps = 4};
  c.masks[0].available = false;
  const Solution r = run_saga({}, test::Quiet(), options, c.input());
  CHECK(r.figures.at("steps") < 4);
  Problem none = c.input();
  none.views.clear();
  CHECK_THROWS_AS(run_saga({}, test::Quiet(), options, none), Error);
}

}  // namespace ngs
