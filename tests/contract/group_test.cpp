// Masks with ids.
#include <doctest/doctest.h>
#include <signal.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

/// The mask of the ball in view `v` of the fixture, 0/255.
ImageU16 ball(int v) {
  const io::RawMask raw =
      io::read_mask_raw(test::fixture_folder() + "/masks/v" + std::to_string(v) + ".png", io::Palette::kMask);
  ImageU16 image(raw.width_px, raw.height_px, 1);
  image.data = raw.data;
  return image;
}

struct Group {
  test::TempDir dir;
  Group() { std::filesystem::create_directories(dir.path() + "/all"); }
  std::string mask(int v) const { return dir.path() + "/all/v" + std::to_string(v) + ".png"; }
  test::ProcessResult run(const std::string& out) const {
    return test::run_tool({"ngs-group", test::fixture_folder() + "/scene.json", "--masks", "all", "-o", out},
                          dir.path());
  }
};

}  // namespace

TEST_CASE("an object whose id is another one in every view, up to 65535, gets one id") {
  const Group group;
  for (int v = 0; v < 5; ++v) {
    ImageU16 ids = ball(v);
    for (std::uint16_t& id : ids.data) id = id > 0 ? std::uint16_t(65535 - 13000 * v) : std::uint16_t(0);
    io::write_png16(group.mask(v), ids);
  }
  REQUIRE(group.run("g").exit_code == 0);
  for (int v = 0; v < 5; ++v) {
    CAPTURE(v);
    const io::RawMask found =
        io::read_mask_raw(group.dir.path() + "/g/masks/v" + std::to_string(v) + ".png", io::Palette::kIndices);
    const ImageU16 truth = ball(v);
    for (std::size_t p = 0; p < truth.data.size(); ++p)
      if (truth.data[p] > 0) CHECK(found.data[p] == 1);
  }
}

TEST_CASE("masks of two programs, one with large ids and one that divides the object in a view, are one object") {
  const Group group;
  for (int v = 0; v < 5; ++v) {
    ImageU16 ids = ball(v);
    const int width = ids.width_px;
    for (std::size_t p = 0; p < ids.data.size(); ++p) {
      const bool upper = int(p) / width < ids.height_px / 2;
      if (ids.data[p] > 0) ids.data[p] = v % 2 == 0 ? std::uint16_t(300 + v) : std::uint16_t(v == 1 && upper ? 2 : 1);
    }
    io::write_png16(group.mask(v), ids);
  }
  const test::ProcessResult result = test::succeeded(group.run("g"));
  CHECK(result.out.find("\"objects\": 1") != std::string::npos);
}

TEST_CASE("ngs cut --all, stopped by Ctrl-C and called again, writes the bytes of a run that was not stopped") {
  const Group group;
  for (int v = 0; v < 5; ++v) io::write_png16(group.mask(v), ball(v));
  const auto spec = [&](const std::string& out) {
    const std::string scene = test::fixture_folder() + "/scene.json";
    test::ProcessSpec cut = test::command({"ngs", "cut", scene, "--all", "--masks", "all", "-o", out});
    cut.folder = group.dir.path();
    return cut;
  };
  test::succeeded(test::run_process(spec("whole")));
  test::ProcessSpec stopped = spec("resumed");
  stopped.signal = SIGINT;
  stopped.signal_after = "finding the objects";
  CHECK(test::run_process(stopped).exit_code == 128 + SIGINT);
  CHECK_FALSE(std::filesystem::exists(group.dir.path() + "/resumed/objects.json"));
  test::succeeded(test::run_process(spec("resumed")));
  for (const char* file : {"/objects.json", "/background.ply", "/labelled.ply", "/objects/001.ply"})
    CHECK(test::read_bytes(group.dir.path() + "/whole" + file) ==
          test::read_bytes(group.dir.path() + "/resumed" + file));
}

TEST_CASE("a view with more ids than masks of one view can have is an error") {
  const Group group;
  for (int v = 0; v < 5; ++v) {
    ImageU16 ids = ball(v);
    for (std::size_t p = 0; v == 2 && p < ids.data.size(); ++p) ids.data[p] = std::uint16_t(p);
    io::write_png16(group.mask(v), ids);
  }
  test::refused(group.run("g"), 3, "v2.png: 1727 masks in one view, expected at most 1024");
  CHECK_FALSE(std::filesystem::exists(group.dir.path() + "/g/scene.json"));
}

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
    test::refused(maps.eval(std::move(flags)), 3, "a.exr: " + because);
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
