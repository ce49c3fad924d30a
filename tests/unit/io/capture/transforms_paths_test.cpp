// Image names and paths in camera files.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/transforms_json.h"
#include "support/camera_files.h"

namespace ngs::io {
namespace {

TransformsSource no_images() {
  return {"/data",
          "transforms.json",
          false,
          {[](const std::string&) { return false; }, [](const std::string&) { return ImageSize{}; }}};
}

}  // namespace

TEST_CASE("transforms.json: with absolute and relative image paths names are relative to the common folder") {
  const auto views = test::random_cameras(2, false);
  for (const int absolute : {0, 1}) {
    nlohmann::json root = test::transforms_json(views);
    root["frames"][std::size_t(absolute)]["file_path"] = "/data/images/1.png";
    root["frames"][std::size_t(1 - absolute)]["file_path"] = "images/2.png";
    const Capture capture = parse_transforms_json(root, no_images());
    CHECK(capture.views[0].camera.name == "1.png");
    CHECK(capture.views[1].camera.name == "2.png");
    CHECK(capture.views[1].image_path == "/data/images/2.png");
    root["frames"][std::size_t(absolute)]["file_path"] = "/elsewhere/1.png";
    CHECK(parse_transforms_json(root, no_images()).views[1].camera.name == "elsewhere/1.png");
  }
}

TEST_CASE("transforms.json: backslashes separate folders, unless a file has that exact name") {
  nlohmann::json root = test::transforms_json(test::random_cameras(2, false));
  root["frames"][0]["file_path"] = R"(.\images\left\1.png)", root["frames"][0]["mask_path"] = R"(masks\1.png)";
  root["frames"][1]["file_path"] = R"(images\right\1.png)";
  TransformsSource source = no_images();
  Capture capture = parse_transforms_json(root, source);
  CHECK(capture.views[0].camera.name == "left/1.png");
  CHECK(capture.views[1].image_path == "/data/images/right/1.png");
  CHECK(capture.views[0].mask_path == "/data/masks/1.png");
  source.images.exists = [](const std::string& path) { return path == R"(/data/images\right\1.png)"; };
  capture = parse_transforms_json(root, source);
  CHECK(capture.views[1].image_path == R"(/data/images\right\1.png)");
}

TEST_CASE("transforms.json: a frame without size and image has the size of the others, or is left out if they differ") {
  nlohmann::json root = test::transforms_json(test::random_cameras(3, false));
  root.erase("w"), root.erase("h");
  for (auto& frame : root["frames"]) frame.erase("w"), frame.erase("h");
  for (int i = 0; i < 3; ++i) root["frames"][std::size_t(i)]["file_path"] = "images/" + std::to_string(i) + ".png";
  TransformsSource source = no_images();
  source.images.exists = [](const std::string& path) {
    return path == "/data/images/0.png" || path == "/data/images/2.png";
  };
  source.images.size = [](const std::string&) { return ImageSize{64, 48}; };
  Capture capture = parse_transforms_json(root, source);
  REQUIRE(capture.views.size() == 3);
  REQUIRE(!capture.notes.empty());
  CHECK(capture.views[1].camera.width_px == 64);
  CHECK(capture.notes.back().find("the size of the others is used (/data/images/1.png)") != std::string::npos);
  source.images.size = [](const std::string& path) { return ImageSize{64, path.ends_with("0.png") ? 48 : 32}; };
  capture = parse_transforms_json(root, source);
  REQUIRE(capture.views.size() == 2);
  CHECK(capture.views[1].camera.name == "2.png");
  CHECK(capture.notes.back().find("are left out") != std::string::npos);
  CHECK_THROWS_WITH_AS(parse_transforms_json(root, no_images()), doctest::Contains("expected a size"), Error);
}

TEST_CASE("COLMAP names that are absolute or lead out of the folder become relative to the folder that all share") {
  const std::string camera = "1 SIMPLE_RADIAL 640 480 500 320 240 0.1\n", pose = " 1 0 0 0 0 0 0 1 ";
  const auto names_of = [&](const std::string& a, const std::string& b) {
    const Capture capture =
        parse_colmap_text(camera, "1" + pose + a + "\n\n2" + pose + b + "\n\n", "m", Distortion::kKept);
    CHECK(capture.lenses.size() == 2);
    CHECK(capture.lenses.contains(capture.views[0].camera.name));
    CHECK(capture.notes.size() == 1);
    return capture.views[0].camera.name + " " + capture.views[1].camera.name;
  };
  CHECK(names_of("/data/images/a.png", "/data/images/b.png") == "a.png b.png");
  CHECK(names_of("../images/left/a.png", "../images/right/a.png") == "left/a.png right/a.png");
  CHECK(names_of("C:/scan/a.png", "C:/scan/b/a.png") == "a.png b/a.png");
  CHECK(names_of("a.png", "/data/images/b.png") == "a.png b.png");
}

}  // namespace ngs::io
