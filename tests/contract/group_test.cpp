// ngs-group on label maps of 16 bits whose ids differ between the views.
#include <doctest/doctest.h>
#include <signal.h>

#include <filesystem>
#include <nlohmann/json.hpp>

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
  const test::ProcessResult result = group.run("g");
  CHECK(result.exit_code == 3);
  CHECK(result.err.find("v2.png: 1727 masks in one view, expected at most 1024") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(group.dir.path() + "/g/scene.json"));
}

}  // namespace ngs
