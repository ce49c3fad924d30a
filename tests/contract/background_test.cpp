// The background colour of a model: import estimates it, later tools read it from scene.json.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/ball_scene.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

using nlohmann::json;

json read(const std::string& path) {
  std::ifstream file(path);
  return json::parse(file);
}

test::ProcessResult run(std::vector<std::string> words) {
  const test::ProcessResult result = test::run_process(test::command(json(words)));
  CAPTURE(words.front());
  CAPTURE(result.err);
  CHECK(result.exit_code == 0);
  return result;
}

test::ProcessResult import(const std::string& dir, std::vector<std::string> further = {}) {
  std::vector<std::string> words{
      "ngs-scene",    "import",     dir + "/text", "--ply", dir + "/model.ply",  "--images", dir + "/images", "--masks",
      dir + "/masks", "--hold-out", "every:3:1",   "-o",    dir + "/scene.json", "-w"};
  words.insert(words.end(), further.begin(), further.end());
  return run(words);
}

/// Mean boundary IoU of all views, labelled by ngs-joint with the options `further`.
double boundary_iou(const std::string& dir, std::vector<std::string> further) {
  std::vector<std::string> words{"ngs-joint", dir + "/scene.json", dir + "/boundary.ply", "-o", dir + "/l.ply", "-w"};
  words.insert(words.end(), further.begin(), further.end());
  run(words);
  run({"ngs-render", dir + "/scene.json", dir + "/l.ply", "--layers", "mask", "-o", dir + "/rendered", "-w"});
  run({"ngs-eval", dir + "/rendered", dir + "/masks", "-o", dir + "/metrics.json", "-w"});
  return read(dir + "/metrics.json").at("mean").at("biou").get<double>();
}

double colour_db(const std::string& dir, std::vector<std::string> further) {
  std::vector<std::string> words{
      "ngs-render", dir + "/scene.json", dir + "/model.ply", "--layers", "color", "-o", dir + "/colour", "-w"};
  words.insert(words.end(), further.begin(), further.end());
  run(words);
  run({"ngs-eval", dir + "/colour", dir + "/images", "--image-metrics", "-o", dir + "/photos.json", "-w"});
  return read(dir + "/photos.json").at("mean").at("psnr_db").get<double>();
}

}  // namespace

TEST_CASE(
    "ngs-joint labels an object on white no worse than its masks alone, because import finds the white background") {
  const test::TempDir dir;
  test::write_ball_scene(dir.path(), {1, 1, 1});
  import(dir.path());
  CHECK(read(dir.path() + "/scene.json").at("background") == json({1.0, 1.0, 1.0}));
  run({"ngs-variance", dir.path() + "/scene.json", "-o", dir.path() + "/boundary.ply"});
  const double flash = boundary_iou(dir.path(), {"--method", "flash"}), found = boundary_iou(dir.path(), {}),
               black = boundary_iou(dir.path(), {"--background", "black"});
  MESSAGE("flash ", flash, " found ", found, " black ", black);
  CHECK(found >= flash - 0.002);
  CHECK(black < found - 0.02);
  const double over_found = colour_db(dir.path(), {}), over_black = colour_db(dir.path(), {"--background", "0,0,0"});
  CHECK(over_found > over_black + 10);
}

TEST_CASE("a --background that differs from the scene's is used, with a warning") {
  const test::TempDir dir;
  test::write_ball_scene(dir.path(), {0.6f, 0, 0.4f});
  import(dir.path());
  const json found = read(dir.path() + "/scene.json").at("background");
  CHECK(std::abs(found[0].get<double>() - 0.6) < 0.01);
  CHECK(std::abs(found[1].get<double>()) < 0.01);
  CHECK(std::abs(found[2].get<double>() - 0.4) < 0.01);
  const test::ProcessResult render = run({"ngs-render", dir.path() + "/scene.json", dir.path() + "/model.ply",
                                          "--layers", "color", "--background", "white", "-o", dir.path() + "/r"});
  CHECK(render.err.find("is not the scene's") != std::string::npos);
  import(dir.path(), {"--background", "white"});
  CHECK(read(dir.path() + "/scene.json").at("background") == json({1.0, 1.0, 1.0}));
}

TEST_CASE("transparent photos are composited over the background that the model was fitted with") {
  for (const double level : {0.0, 1.0}) {
    CAPTURE(level);
    const test::TempDir dir;
    test::write_cut_out_ball_scene(dir.path(), {float(level), float(level), float(level)});
    const test::ProcessResult result = import(dir.path());
    CHECK(result.err.find("photos are transparent") != std::string::npos);
    CHECK(read(dir.path() + "/scene.json").at("background") == json({level, level, level}));
  }
}

}  // namespace ngs
