// What the query points' gradients ask of the depth map that their windows follow. Mutants this kills: alpha or the
// window's width counted as constant.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/ops/field/ray_query.h"
#include "ngs/ops/field/sample_grid.h"
#include "support/cameras.h"

namespace ngs {
namespace {

/// A view whose query points follow a depth map, and a number that is linear in the points and in their spacing.
struct DepthCase {
  static constexpr int kWidth = 60, kHeight = 50;
  Camera camera;
  RayOptions options;
  PixelGrid grid = pixel_grid({4, 3, 55, 47}, 6, 7, GridNodes::kCentres);
  ImageF depth{kWidth, kHeight, 1}, alpha{kWidth, kHeight, 1};
  QueryGradients weight;

  DepthCase(test::Random& random, RayOptions o) : camera(test::camera_around(random, 4)), options(o) {
    camera.width_px = kWidth, camera.height_px = kHeight, camera.cx = 30, camera.cy = 25;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        alpha.at(x, y, 0) = x < 15 ? 0.1f : float(random.uniform(0.7, 1));  // on the left nothing to follow
        depth.at(x, y, 0) = alpha.at(x, y, 0) * float(random.uniform(3, 4));
      }
    const auto rays = std::size_t(grid.nodes());
    weight.position = random.uniform_vector<float>(rays * std::size_t(o.samples) * 3, -1, 1);
    weight.spacing = random.uniform_vector<float>(rays, -1, 1);
  }
  RayQueries rays() const { return ray_queries({}, camera, grid, options, {&depth, &alpha}); }
  double value() const {
    const RayQueries q = rays();
    double sum = 0;
    for (std::size_t i = 0; i < q.position.size(); ++i) sum += double(q.position[i]) * double(weight.position[i]);
    for (std::size_t i = 0; i < q.spacing.size(); ++i) sum += double(q.spacing[i]) * double(weight.spacing[i]);
    return sum;
  }
  /// Slope of value() where `image` moves along `v`.
  double slope(ImageF& image, const std::vector<double>& v) const {
    const double h = 2e-3;
    const std::vector<float> at(image.data.begin(), image.data.end());
    double sides[2];
    for (const int side : {0, 1}) {
      for (std::size_t i = 0; i < v.size(); ++i) image.data[i] = float(double(at[i]) + (side ? -h : h) * v[i]);
      sides[side] = value();
    }
    std::copy(at.begin(), at.end(), image.data.begin());
    return (sides[0] - sides[1]) / (2 * h);
  }
};

}  // namespace

TEST_CASE("what query points ask of their depth map is the slope of what is computed from them") {
  // Windows in proportion to the distance, of one width for all, and one sample in the middle.
  const RayOptions options[] = {{.samples = 4, .depth_span = 0.1, .mean_distance = 4},
                                {.samples = 4, .depth_span = 0.01, .depth_epsilon = 0.2, .mean_distance = 4},
                                {.samples = 1, .depth_span = 0.1, .mean_distance = 4}};
  test::Random random(31);
  for (const RayOptions& o : options) {
    CAPTURE(o.samples);
    CAPTURE(o.depth_span);
    DepthCase c(random, o);
    ImageF to_depth(c.kWidth, c.kHeight, 1), to_alpha(c.kWidth, c.kHeight, 1);
    add_depth_gradients({c.camera, c.rays(), o, {&c.depth, &c.alpha}}, c.weight, {to_depth, to_alpha});
    const auto agrees = [&](const ImageF& gradient, ImageF& image) {
      double most = 0, square = 0;
      for (const float g : gradient.data) most = std::max(most, std::abs(double(g))), square += double(g) * double(g);
      REQUIRE(most > 0.1);
      std::vector<double> uphill(gradient.data.begin(), gradient.data.end());
      for (double& x : uphill) x /= most;
      // Rounding of 168 positions: 1e-7 · sqrt(168) / 4e-3 = 3e-4, of slopes of 10 and more.
      CHECK(square / most == doctest::Approx(c.slope(image, uphill)).epsilon(1e-3));
    };
    agrees(to_depth, c.depth);
    agrees(to_alpha, c.alpha);
    CHECK(to_depth.at(5, 20, 0) == 0);
  }
}

}  // namespace ngs
