// Cameras read with their distortion: the lenses of COLMAP's models and of transforms.json.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/transforms_json.h"
#include "support/camera_files.h"

namespace ngs::io {
namespace {

constexpr double kRounding = 1e-14;

Lens colmap_lens(const std::string& camera) {
  const Capture capture =
      parse_colmap_text("1 " + camera + "\n", "1 1 0 0 0 0 0 0 1 a.png\n\n", "sparse", Distortion::kKept);
  const auto found = capture.lenses.find("a.png");
  return found == capture.lenses.end() ? Lens{} : found->second;
}

nlohmann::json transforms(const nlohmann::json& more) {
  nlohmann::json root = test::transforms_json(test::random_cameras(1, false));
  root.update(more);
  return root;
}

Capture transforms_capture(const nlohmann::json& root) {
  return parse_transforms_json(
      root, {"/data",
             "transforms.json",
             false,
             {[](const std::string&) { return false; }, [](const std::string&) { return ImageSize{}; }},
             Distortion::kKept});
}

}  // namespace

TEST_CASE("lenses of COLMAP's camera models distort a direction according to their formulas") {
  // Computed from the formulas of COLMAP's documentation, independently of this code, at (0.5, -0.25).
  const struct {
    const char* camera;
    double x, y;
  } known[] = {
      {"SIMPLE_RADIAL 640 480 500 320 240 -0.1", 0.484375, -0.2421875},
      {"RADIAL 640 480 500 320 240 -0.1 0.02", 0.4853515625, -0.24267578125},
      {"OPENCV 640 480 500 501 320 240 -0.1 0.02 0.003 -0.004", 0.48135156250000005, -0.24036328125},
      {"OPENCV_FISHEYE 640 480 500 501 320 240 -0.1 0.02 0.005 -0.001", 0.44473206046859953, -0.22236603023429977},
      {"FULL_OPENCV 640 480 500 501 320 240 -0.1 0.02 0.003 -0.004 0.005 0.01 -0.02 0.003", 0.480815327314733,
       -0.24009516365736647},
      {"FOV 640 480 500 501 320 240 0.9", 0.49212277731701753, -0.24606138865850877},
      {"SIMPLE_RADIAL_FISHEYE 640 480 500 320 240 -0.1", 0.4440785220499651, -0.22203926102498256},
      {"RADIAL_FISHEYE 640 480 500 320 240 -0.1 0.02", 0.44469414839125165, -0.22234707419562583},
      {"THIN_PRISM_FISHEYE 640 480 500 501 320 240 -0.1 0.02 0.003 -0.004 0.005 -0.001 0.002 -0.006",
       0.4419258474347068, -0.2220022618780544},
      {"PINHOLE 640 480 500 501 320 240", 0.5, -0.25},
      {"SIMPLE_RADIAL 640 480 500 320 240 5e-10", 0.5, -0.25}};
  for (const auto& want : known) {
    CAPTURE(want.camera);
    const Vec2<double> at = distort(colmap_lens(want.camera), {0.5, -0.25});
    CHECK(std::abs(at.x - want.x) < kRounding);
    CHECK(std::abs(at.y - want.y) < kRounding);
  }
}

TEST_CASE("lenses are correct on the optical axis, where the radius is zero") {
  for (const char* camera : {"OPENCV_FISHEYE 640 480 500 501 320 240 0 0 0 0", "FOV 640 480 500 501 320 240 0.9"}) {
    const Vec2<double> at = distort(colmap_lens(camera), {0, 0});
    CHECK(at.x == 0);
    CHECK(at.y == 0);
  }
}

TEST_CASE("kKept: a non-finite lens, a FOV angle outside (0, 180) degrees and an unknown model are rejected") {
  for (const char* camera :
       {"OPENCV 640 480 500 501 320 240 nan 0 0 0", "FOV 640 480 500 501 320 240 0", "FOV 640 480 500 501 320 240 3.2",
        "OPENCV_FISHEYE 640 480 500 501 320 240 0 0 0 inf", "RAD_TAN_THIN_PRISM_FISHEYE 640 480 1 1 1"}) {
    CAPTURE(camera);
    CHECK_THROWS_AS(colmap_lens(camera), Error);
  }
}

TEST_CASE("transforms.json: equal parameters give the same lens as COLMAP") {
  const struct {
    nlohmann::json keys;
    const char* colmap;
  } same[] = {{{{"k1", -0.1}, {"k2", 0.02}, {"p1", 0.003}, {"p2", -0.004}},
               "OPENCV 640 480 500 501 320 240 -0.1 0.02 0.003 -0.004"},
              {{{"camera_model", "SIMPLE_RADIAL"}, {"k1", -0.1}}, "SIMPLE_RADIAL 640 480 500 320 240 -0.1"},
              {{{"camera_model", "OPENCV_FISHEYE"}, {"k1", -0.1}, {"k2", 0.02}, {"k3", 0.005}, {"k4", -0.001}},
               "OPENCV_FISHEYE 640 480 500 501 320 240 -0.1 0.02 0.005 -0.001"},
              {{{"is_fisheye", true}, {"k1", -0.1}}, "SIMPLE_RADIAL_FISHEYE 640 480 500 320 240 -0.1"},
              {{{"camera_model", "FULL_OPENCV"},
                {"k1", -0.1},
                {"k2", 0.02},
                {"k3", 0.005},
                {"k4", 0.01},
                {"k5", -0.02},
                {"k6", 0.003},
                {"p1", 0.003},
                {"p2", -0.004}},
               "FULL_OPENCV 640 480 500 501 320 240 -0.1 0.02 0.003 -0.004 0.005 0.01 -0.02 0.003"}};
  for (const auto& pair : same) {
    CAPTURE(pair.colmap);
    const Capture capture = transforms_capture(transforms(pair.keys));
    REQUIRE(capture.lenses.size() == 1);
    CHECK(capture.lenses.begin()->first == capture.views[0].camera.name);
    const Vec2<double> got = distort(capture.lenses.begin()->second, {0.4, 0.3}),
                       want = distort(colmap_lens(pair.colmap), {0.4, 0.3});
    CHECK(got.x == want.x);
    CHECK(got.y == want.y);
  }
  CHECK(transforms_capture(transforms({{"k1", 0.0}})).lenses.empty());
  CHECK_THROWS_WITH_AS(transforms_capture(transforms({{"k5", 0.1}})), doctest::Contains("expected FULL_OPENCV"), Error);
  CHECK_THROWS_WITH_AS(transforms_capture(transforms({{"camera_model", "EQUIRECTANGULAR"}})),
                       doctest::Contains("camera model EQUIRECTANGULAR"), Error);
}

}  // namespace ngs::io
