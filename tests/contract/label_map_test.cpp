// Masks of every file type and name are scored; label maps have the same ids in import and in scoring.
#include <doctest/doctest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

constexpr int kWidthPx = 8, kHeightPx = 6;

/// A mask of the left half of an image.
std::vector<float> half(float left, float right) {
  std::vector<float> plane;
  for (int p = 0; p < kWidthPx * kHeightPx; ++p) plane.push_back(p % kWidthPx < kWidthPx / 2 ? left : right);
  return plane;
}

struct Maps {
  test::TempDir dir;
  Maps() {
    for (const char* name : {"p", "t"}) std::filesystem::create_directories(dir.path() + "/" + name);
  }
  void write(const std::string& name, std::map<std::string, std::vector<float>> channels) const {
    io::write_exr(dir.path() + "/" + name, {kWidthPx, kHeightPx, std::move(channels), {}, {}});
  }
  void write_grey(const std::string& name, int channels, float left, float right) const {
    ImageU8 image(kWidthPx, kHeightPx, channels);
    const std::vector<float> plane = half(left, right);
    for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = std::uint8_t(plane[i / std::size_t(channels)]);
    io::write_png(dir.path() + "/" + name, image);
  }
  test::ProcessResult eval(std::vector<std::string> further) const {
    return test::run_tool(test::joined(test::split("ngs-eval p t -o m.json -w -q"), further), dir.path());
  }
  nlohmann::json metrics() const { return nlohmann::json::parse(test::read_bytes(dir.path() + "/m.json")); }
};

}  // namespace

TEST_CASE("a grey label map saved as RGB has the same ids as the grey one") {
  const Maps maps;
  maps.write_grey("p/a.png", 3, 7, 0);
  maps.write_grey("t/a.png", 1, 7, 0);
  REQUIRE(maps.eval({"--label-map", "--object-id", "ball=7"}).exit_code == 0);
  CHECK(maps.metrics()["mean"]["iou"] == 1.0);
  maps.write_grey("t/a.png", 3, 7, 0);
  REQUIRE(maps.eval({"--label-map"}).exit_code == 0);
  CHECK(maps.metrics()["objects"][0]["object"] == "7");
}

TEST_CASE("the ids of an EXR are read from its id channel, not from its soft mask") {
  const Maps maps;
  maps.write_grey("t/a.png", 1, 7, 3);
  for (const char* name : {"p/a.exr", "p/a.EXR"}) {
    CAPTURE(name);
    maps.write(name, {{"ngs.id", half(7, 3)}, {"ngs.mask", half(0.25, 0.5)}});
    REQUIRE(maps.eval({"--label-map"}).exit_code == 0);
    CHECK(maps.metrics()["mean"]["iou"] == 1.0);
    maps.write(name, {{"R", half(7, 3)}, {"Z", half(1, 2)}});
    REQUIRE(maps.eval({"--label-map"}).exit_code == 0);
    CHECK(maps.metrics()["mean"]["iou"] == 1.0);
    std::filesystem::remove(maps.dir.path() + "/" + name);
  }
}

TEST_CASE("an EXR without ids or with invalid values is rejected with its name") {
  const Maps maps;
  const auto refused = [&](std::map<std::string, std::vector<float>> channels, std::vector<std::string> flags,
                           const std::string& because) {
    maps.write("p/a.exr", std::move(channels));
    const test::ProcessResult result = maps.eval(std::move(flags));
    INFO(result.err);
    CHECK(result.exit_code == 3);
    CHECK(result.err.find("a.exr: " + because) != std::string::npos);
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  maps.write_grey("t/a.png", 1, 255, 0);
  refused({{"ngs.id", half(7.5, 0)}}, {"--label-map"}, "mask value 7.5");
  refused({{"ngs.id", half(kNan, 0)}}, {"--label-map"}, "mask value nan, expected ids in 0..65535");
  refused({{"ngs.mask", half(0.5, 0)}, {"Z", half(1, 2)}}, {"--label-map"}, "EXR without a channel ngs.id, Y or R");
  refused({{"ngs.mask", half(kNan, 1)}}, {}, "mask value nan, expected [0, 1]");
  refused({{"ngs.mask", half(1, kInfinity)}}, {}, "mask value inf");
}

TEST_CASE("masks with names that are not UTF-8 are scored") {
  const Maps maps;
  for (const char* folder : {"p", "t"}) maps.write_grey(std::string(folder) + "/v\xfc.png", 1, 255, 0);
  REQUIRE(maps.eval({}).exit_code == 0);
  CHECK(maps.metrics()["mean"]["iou"] == 1.0);
  CHECK(maps.metrics()["views"][0]["view"] == "v\xef\xbf\xbd");
}

}  // namespace ngs
