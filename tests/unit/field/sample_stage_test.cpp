#include "ngs/field/sample_stage.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "ngs/core/error.h"
#include "ngs/field/joint_field.h"
#include "ngs/field/rbf_stage.h"
#include "support/cameras.h"
#include "support/error_code.h"
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
    options.rows = 9;
    options.cols = 7;
    options.depth_samples = 4;
  }
  QueryField sample(int threads = 1) {
    return sample_queries({.threads = threads}, monitor, options, {tiny.cloud, boundary, scene, views});
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
  c.options.rows = 33;
  c.options.cols = 41;
  QueryField a = c.sample(), b = c.sample(7);
  CHECK(a.position == b.position);
  interpolate_features({}, c.monitor, {}, c.boundary, a);
  interpolate_features({.threads = 7}, c.monitor, {}, c.boundary, b);
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
    CHECK_THROWS_AS(interpolate_features({}, c.monitor, {.width = width}, c.boundary, field), Error);
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

namespace {

/// Two views of 1 x 2 rays with two samples, and one view without rays.
QueryField sampled() {
  QueryField field;
  field.origin = {1, 2, 3};
  for (const char* name : {"a", "b", "c"}) field.views.push_back({name, {}, 1, 2, 2, 3.0});
  for (const std::int32_t view : {0, 2})
    for (std::int32_t slot = 0; slot < 4; ++slot) {
      field.view.push_back(view);
      field.slot.push_back(slot);
      field.depth.push_back(2 + 0.1f * float(slot % 2));
      field.position.insert(field.position.end(), {0, 0, 1});
      field.uv.insert(field.uv.end(), {4, 5});
    }
  return field;
}

GaussianCloud cloud() {
  GaussianCloud cloud;
  cloud.origin = {1, 2, 3};
  return cloud;
}

void rejected(const std::function<void(QueryField&)>& spoil, ErrorCode code, const char* what) {
  CAPTURE(what);
  QueryField field = sampled();
  spoil(field);
  test::refused([&] { require_grids(field, cloud(), "f.ply"); }, code, what);
}

}  // namespace

TEST_CASE("require_grids accepts a field of ngs-sample, and rejects missing columns, another order or another origin") {
  CHECK_NOTHROW(require_grids(sampled(), cloud(), "f.ply"));
  rejected([](QueryField& f) { f.uv.clear(); }, ErrorCode::kBadInput, "f.ply: no columns u v");
  rejected([](QueryField& f) { f.depth.clear(); }, ErrorCode::kBadInput, "f.ply: no columns depth");
  rejected([](QueryField& f) { f.view.clear(); }, ErrorCode::kBadInput, "f.ply: no columns view");
  rejected([](QueryField& f) { f.slot.clear(); }, ErrorCode::kBadInput, "f.ply: no columns slot");
  rejected([](QueryField& f) { f.origin[1] = 0; }, ErrorCode::kInconsistent, "another origin");
  rejected([](QueryField& f) { std::swap(f.slot[4], f.slot[5]); }, ErrorCode::kBadInput, "row 4 is slot 1 of view 2");
  rejected([](QueryField& f) { std::swap_ranges(f.view.begin(), f.view.begin() + 4, f.view.begin() + 4); },
           ErrorCode::kBadInput, "row 4 is slot 0 of view 0");
  rejected([](QueryField& f) { f.depth[3] = NAN; }, ErrorCode::kBadInput, "row 3 has no pixel or no depth");
  rejected([](QueryField& f) { f.uv[9] = INFINITY; }, ErrorCode::kBadInput, "row 4 has no pixel or no depth");
}

}  // namespace ngs
