// Image paths in transforms.json.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

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

}  // namespace ngs::io
