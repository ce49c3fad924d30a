// ngs-scene orbit on a splat without photos, then the other tools on its renders instead of photos.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/process.h"
#include "support/splat_shapes.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

void run_tool(const test::TempDir& dir, std::vector<std::string> argv) {
  argv[0] = std::string(NGS_TOOL_DIR "/") + argv[0];
  test::succeeded(test::run_process({.argv = argv, .environment = {{"NGS_THREADS", "2"}}, .folder = dir.path()}));
}

Json json_of(const test::TempDir& dir, const std::string& name) {
  return Json::parse(test::read_bytes(dir.path() + "/" + name));
}

/// A red ball on a grey box.
GaussianCloud ball_on_box() {
  GaussianCloud cloud;
  test::add_sphere(cloud, {0, 0, 0.5}, 0.5, 700);
  const std::int64_t ball = cloud.size();
  test::add_box(cloud, {-0.6, -0.6, -0.8}, {0.6, 0.6, 0}, 0.08);
  for (std::int64_t i = 0; i < cloud.size(); ++i) {
    float* dc = &cloud.sh_dc[3 * std::size_t(i)];
    dc[0] = i < ball ? 1.5f : 0.1f, dc[1] = i < ball ? -1.2f : 0.1f, dc[2] = i < ball ? -1.2f : 0.1f;
  }
  return cloud;
}

}  // namespace

TEST_CASE(
    "a splat without photos is rendered, marked and labelled, and every report records that the photos are renders") {
  const test::TempDir dir;
  dir.write("model.ply", test::strict_ply_bytes(ball_on_box()));
  fs::create_directory(dir.path() + "/alone");
  run_tool(dir, {"ngs-scene", "orbit", "model.ply", "--up", "z", "--place", "outside", "--view-count", "10", "--size",
                 "96x96", "-o", "alone/scene.json", "-q", "--report", "orbit.json"});
  const Json scene = json_of(dir, "alone/scene.json"), orbit = json_of(dir, "orbit.json")["result"];
  CHECK(scene["renders"]["note"] == "renders of the model, no photos");
  CHECK(scene["renders"]["coverage"] == orbit["coverage"]);
  CHECK(orbit["coverage"] >= 0.95);
  CHECK(scene["views"].size() == orbit["views"]);
  for (const Json& view : scene["views"]) CHECK(fs::exists(dir.path() + "/alone/" + std::string(view["image"])));

  // The first camera is at the height of the bulk: the ball is in the upper part of its image, the box in the lower
  // part.
  dir.write("strokes.json",
            R"({"ngs_prompts":1,"view":"0000.png","width":96,"height":96,"strokes":[
               {"object":true,"radius":2,"points":[[44,32],[52,32]]},
               {"object":false,"radius":2,"points":[[40,66],[56,66]]},
               {"object":false,"radius":1,"points":[[3,3],[92,3],[92,92],[3,92],[3,3]]}]})");
  run_tool(dir, {"ngs-mask", "alone/scene.json", "--prompts", "strokes.json", "-o", "alone/masks", "-q", "--report",
                 "mask.json"});
  CHECK(json_of(dir, "mask.json")["result"]["photos"] == "renders of the model, no photos");
  run_tool(dir, {"ngs-scene", "import", "alone", "-o", "masked.json", "-q", "--report", "import.json"});
  const Json masked = json_of(dir, "masked.json");
  CHECK(masked["renders"] == scene["renders"]);
  CHECK(masked["background"] == scene["background"]);
  CHECK(masked["views"][3]["rotation"] == scene["views"][3]["rotation"]);  // not aligned
  run_tool(dir, {"ngs-variance", "masked.json", "-o", "boundary.ply", "-q", "--report", "variance.json"});
  run_tool(dir, {"ngs-joint", "masked.json", "boundary.ply", "--quality", "draft", "-o", "labelled.ply", "-q",
                 "--report", "joint.json"});
  for (const char* report : {"import.json", "variance.json", "joint.json"}) {
    CAPTURE(report);
    CHECK(json_of(dir, report)["result"]["photos"] == "renders of the model, no photos");
  }

  // Fewer views replace more: no render of an earlier run remains.
  run_tool(dir, {"ngs-scene", "orbit", "model.ply", "--up", "z", "--place", "outside", "--view-count", "4",
                 "--max-views", "4", "--size", "96x96", "-w", "-o", "alone/scene.json", "-q"});
  CHECK(fs::exists(dir.path() + "/alone/images/0003.png"));
  CHECK_FALSE(fs::exists(dir.path() + "/alone/images/0004.png"));
}

}  // namespace ngs
