// Camera models that cannot be converted to a pinhole: COLMAP's newer ones and panoramas.
#include <doctest/doctest.h>

#include <functional>

#include "ngs/core/error.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/transforms_json.h"
#include "support/camera_files.h"
#include "support/error_code.h"

namespace ngs::io {

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
