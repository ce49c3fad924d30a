#include "ngs/field/sample_stage.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/cameras.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

struct Capture {
  test::TinyScene tiny = test::tiny_scene();
  Scene scene;
  BoundarySet boundary;
  std::vector<std::size_t> views;
  SampleOptions options;
  Monitor monitor;

  Capture() {
    for (const Camera& camera : tiny.cameras) {
      views.push_back(scene.views.size());
      scene.views.push_back({camera, "", "", Split::kTrain});
    }
    boundary = boundary_set(tiny.cloud, tiny.is_object);
    options.rows = 9, options.cols = 7, options.depth_samples = 4;
  }
  QueryField sample(int threads = 1) {
    Exec exec;
    exec.threads = threads;
    return sample_queries(exec, monitor, options, {tiny.cloud, boundary, scene, views});
  }
};

}  // namespace

TEST_CASE("sampling writes one row per view, node and depth, and each projects to its own pixel") {
  Capture c;
  const QueryField field = c.sample();
  REQUIRE(field.size() == std::int64_t(6 * 9 * 7 * 4));
  CHECK(field.views.size() == 6);
  for (std::size_t i = 0; i < std::size_t(field.size()); ++i) {
    const Camera& camera = c.scene.views[std::size_t(field.view[i])].camera;
    const QueryView& view = field.views[std::size_t(field.view[i])];
    CHECK(view.name == camera.name);
    const float* p = &field.position[i * 3];
    const Vec2<double> at = test::project(camera, {p[0], p[1], p[2]});
    CHECK(std::abs(at.x - double(field.uv[i * 2])) < 1e-3);
    CHECK(std::abs(at.y - double(field.uv[i * 2 + 1])) < 1e-3);
    const int node = field.slot[i] / view.depth_samples;
    const PixelGrid grid = pixel_grid(view.box, c.options.rows, c.options.cols);
    CHECK(float(grid.x(node % view.cols)) == field.uv[i * 2]);
    CHECK(float(grid.y(node / view.cols)) == field.uv[i * 2 + 1]);
  }
}

TEST_CASE("depth windows are centred on the rendered depth") {
  Capture c;
  const QueryField field = c.sample();
  int beyond = 0;  // outside of windows centred on the mean distance
  for (std::size_t i = 0; i < field.depth.size(); ++i) {
    const double relative = double(field.depth[i]) / field.views[std::size_t(field.view[i])].mean_depth;
    beyond += relative < 0.9 - 1e-6 || relative > 1.1 + 1e-6;
  }
  CHECK(beyond > 0);
}

TEST_CASE("a view without visible boundary has no queries") {
  Capture c;
  c.scene.views[2].camera.translation.z = -50;  // the scene is behind the camera
  const QueryField field = c.sample();
  CHECK(field.views[2].rows == 0);
  CHECK(field.size() == std::int64_t(5 * 9 * 7 * 4));
  c.boundary = {};
  CHECK(c.sample().size() == 0);
}

TEST_CASE("sampling and interpolation are bit-identical for any number of threads") {
  Capture c;
  QueryField a = c.sample(), b = c.sample(7);
  CHECK(a.position == b.position);
  Exec seven;
  seven.threads = 7;
  interpolate_features({}, c.monitor, {}, c.boundary, a);
  interpolate_features(seven, c.monitor, {}, c.boundary, b);
  CHECK(a.feature == b.feature);
  CHECK(a.neighbour == b.neighbour);
}

TEST_CASE("interpolation lists neighbours by their rows in the model") {
  Capture c;
  QueryField field = c.sample();
  const RbfSummary summary = interpolate_features({}, c.monitor, {}, c.boundary, field);
  CHECK(summary.width > 0);
  REQUIRE(field.neighbours == 8);
  for (std::size_t i = 0; i < field.neighbour.size(); ++i) CHECK(c.tiny.is_object[field.neighbour[i]] == 1);
  // One query recomputed by hand.
  double want = 0;
  for (std::size_t k = 0; k < 8; ++k)
    want +=
        double(field.weight[k]) * (0.5 + 0.28209479177387814 * double(c.tiny.cloud.sh_dc[field.neighbour[k] * 3 + 1]));
  CHECK(double(field.feature[1]) == doctest::Approx(want).epsilon(1e-6));
}

TEST_CASE("interpolation fails for bad widths, non-finite positions and another model's queries") {
  Capture c;
  QueryField field = c.sample();
  for (const char* width : {"", "x", "0", "-1", "inf", "nan", "0.3m"}) {
    RbfOptions options;
    options.width = width;
    CHECK_THROWS_AS(interpolate_features({}, c.monitor, options, c.boundary, field), Error);
  }
  CHECK(rbf_width({}, {.width = "0.35"}, c.boundary.positions()) == 0.35);
  QueryField bad = field;
  bad.position[7] = NAN;
  CHECK_THROWS_AS(interpolate_features({}, c.monitor, {}, c.boundary, bad), Error);
  bad = field;
  bad.origin[0] = 1;
  CHECK_THROWS_AS(interpolate_features({}, c.monitor, {}, c.boundary, bad), Error);
}

TEST_CASE("the defaults equal the values stated in the paper") {
  const SampleOptions options;
  CHECK(options.depth_samples == 8);
  CHECK(options.bbox_pad_px == 5);
  CHECK(options.depth_span == 0.1);
  CHECK(most_queries(options, 2) == 2 * 64 * 64 * 8);
}

}  // namespace ngs
