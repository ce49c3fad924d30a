#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/transforms_json.h"
#include "support/camera_files.h"
#include "support/error_code.h"

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
  TransformsSource source = test::no_images();
  source.distortion = Distortion::kKept;
  return parse_transforms_json(root, source);
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

using test::random_cameras;

TEST_CASE("unsupported camera models are named in the error, with a working alternative") {
  const auto refusal = [](const std::function<void()>& read) {
    const Error e = test::thrown_by(read);
    CHECK(e.code() == ErrorCode::kBadInput);
    return std::string(e.what()) + " -> " + e.remedy();
  };
  test::ByteWriter panorama;
  panorama.put(std::uint64_t(1)).put(std::int32_t(1)).put(std::int32_t(17));
  panorama.put(std::uint64_t(4000)).put(std::uint64_t(2000)).put(4000.0).put(2000.0);
  const test::ColmapFiles files = test::colmap_binary(random_cameras(1, false));
  const auto bytes = [](const std::string& text) {
    return Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  };
  const std::string images = test::colmap_text(random_cameras(1, false)).images;
  for (const Distortion distortion : {Distortion::kRefused, Distortion::kKept}) {
    const std::string said =
        refusal([&] { parse_colmap_binary(bytes(panorama.bytes), bytes(files.images), "m", distortion); });
    CHECK(said.find("EQUIRECTANGULAR") != std::string::npos);
    CHECK(said.find("cut each panorama into pinhole views") != std::string::npos);
    CHECK(said.find("ngs-scene undistort") == std::string::npos);
    for (const auto& [model, parameters] :
         {std::pair("RAD_TAN_THIN_PRISM_FISHEYE", "500 500 32 24 1 0 0 0 0 0 0 0 0 0 0 0"),
          {"SIMPLE_DIVISION", "500 32 24 0.1"},
          {"DIVISION", "500 500 32 24 0.1"},
          {"EUCM", "500 500 32 24 0.5 1"}}) {
      CAPTURE(model);
      const std::string text = refusal(
          [&] { parse_colmap_text(std::string("1 ") + model + " 64 48 " + parameters, images, "m", distortion); });
      CHECK(text.find(model) != std::string::npos);
      CHECK(text.find("colmap image_undistorter") != std::string::npos);
      CHECK(text.find("ngs-scene undistort") == std::string::npos);
    }
    nlohmann::json root = test::transforms_json(random_cameras(1, false));
    root["camera_model"] = "EQUIRECTANGULAR";
    const std::string json = refusal([&] {
      parse_transforms_json(root, {"", "t.json", false, images_on_disk(), distortion});
    });
    CHECK(json.find("EQUIRECTANGULAR") != std::string::npos);
    CHECK(json.find("cut each panorama into pinhole views") != std::string::npos);
    CHECK(json.find("ngs-scene undistort") == std::string::npos);
  }
  for (const auto& [model, parameters] : {std::pair("SIMPLE_FISHEYE", "500 32 24"), {"FISHEYE", "500 510 32 24"}}) {
    const Capture kept =
        parse_colmap_text(std::string("1 ") + model + " 64 48 " + parameters, images, "m", Distortion::kKept);
    CHECK(kept.lenses.begin()->second.kind == Lens::Kind::kFisheye);
  }
  CHECK(parse_colmap_text("1 DIVISION 64 48 500 500 32 24 0", images, "m").views.size() == 1);
}

}  // namespace ngs::io
