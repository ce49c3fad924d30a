// A capture by a rig: each camera has its own folder, with the same photo names.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "support/process.h"
#include "support/splat_shapes.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

/// The tiny scene with its views v0 ... v5 renamed to cam0/0 cam0/1 cam0/2 cam1/0 cam1/1 cam1/2.
struct Rig {
  test::TempDir dir;
  Rig() {
    test::write_tiny_scene(dir.path());
    std::string images = test::read_bytes(dir.path() + "/text/images.txt");
    for (int v = 0; v < 6; ++v) {
      const std::string old_name = "v" + std::to_string(v) + ".png", name = view(v) + ".png";
      for (const char* folder : {"images/", "masks/"})
        fs::rename(dir.path() + "/" + folder + old_name, dir.file(folder + name));
      images.replace(images.find(old_name), old_name.size(), name);
    }
    fs::remove_all(dir.path() + "/sparse");
    fs::rename(dir.path() + "/text", dir.file("sparse/0"));
    dir.write("sparse/0/images.txt", images);
    for (const char* name : {"scene.json", "transforms.json", "cameras.json"}) fs::remove(dir.path() + "/" + name);
  }
  static std::string view(int v) { return "cam" + std::to_string(v / 3) + "/" + std::to_string(v % 3); }

  test::ProcessResult run(test::Words argv) const {
    argv[0] = (argv[0] == "ngs-gs.sh" ? NGS_SOURCE_DIR "/pipelines/" : NGS_TOOL_DIR "/") + argv[0];
    return test::run_process(
        {.argv = argv, .environment = {{"NGS_BIN", NGS_TOOL_DIR}, {"NGS_THREADS", "2"}}, .folder = dir.path()});
  }
  /// The files below a folder, without their extensions.
  std::set<std::string> files(const std::string& folder) const {
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir.path() + "/" + folder))
      if (entry.is_regular_file())
        names.insert(entry.path().lexically_relative(dir.path() + "/" + folder).replace_extension().string());
    return names;
  }
};

}  // namespace

TEST_CASE("every tool that writes a file per view writes one for each view of a rig") {
  const Rig rig;
  const auto done = [&](std::vector<std::string> argv) {
    CAPTURE(argv);
    test::succeeded(rig.run(std::move(argv)));
  };
  std::set<std::string> views;
  for (int v = 0; v < 6; ++v) views.insert(Rig::view(v));
  done({"ngs-scene", "import", ".", "-o", "scene.json"});
  done({"ngs-variance", "scene.json", "-o", "boundary.ply", "--exr", "layers"});
  CHECK(rig.files("layers") == views);
  done({"ngs-render", "scene.json", "boundary.ply", "--views", "all", "--layers", "mask", "-o", "rendered"});
  CHECK(rig.files("rendered") == views);
  done({"ngs-render", "scene.json", "boundary.ply", "--views", "cam1/2", "--format", "exr", "-o", "one"});
  CHECK(rig.files("one") == std::set<std::string>{"cam1/2"});
  rig.dir.write("p.json", R"({"ngs_prompts": 1, "view": "cam1/0.png", "width": 48, "height": 36,
      "boxes": [[12, 6, 36, 30]]})");
  done({"ngs-mask", "scene.json", "--prompts", "p.json", "-o", "made", "--soft", "soft", "--passes", "1"});
  CHECK(rig.files("made") == views);
  CHECK(rig.files("soft") == views);
  done({"ngs-extract", "boundary.ply", "--scene", "scene.json", "--inpaint", "inpaint"});
  for (const char* part : {"inpaint/images", "inpaint/holes", "inpaint/dilated"}) CHECK(rig.files(part) == views);
  done({"ngs-scene", "check", "inpaint/scene.json"});
  done({"ngs-scene", "import", ".", "--masks", "rendered", "-o", "again.json"});
}

TEST_CASE("ngs-gs.sh scores the held-out views of a rig one by one") {
  const Rig rig;
  test::succeeded(rig.run({"ngs-gs.sh", ".", "out", "--hold-out", "every:3:1", "--method", "flash", "--gt", "masks"}));
  CHECK(rig.files("out/masks") == std::set<std::string>{"cam0/1", "cam1/1"});
  for (const char* name : {"out/metrics.json", "out/metrics_input.json"}) {
    CAPTURE(name);
    const auto metrics = nlohmann::json::parse(std::ifstream(rig.dir.path() + "/" + name));
    std::set<std::string> scored;
    for (const auto& view : metrics.at("views")) scored.insert(view.at("view").get<std::string>());
    CHECK(scored == std::set<std::string>{"cam0/1", "cam1/1"});
    CHECK(metrics.at("objects").size() == 1);
  }
  CHECK(test::read_bytes(rig.dir.path() + "/out/report.html").find("cam1/1") != std::string::npos);
  const test::ProcessResult atlas =
      test::succeeded(rig.run({"ngs-report", "out", "-o", "atlas.html", "--atlas", "atlas"}));
  CHECK(rig.files("atlas") == std::set<std::string>{"cam0/1", "cam1/1"});
}

TEST_CASE("a prompts file that matches two views of a rig requires --view") {
  const Rig rig;
  REQUIRE(rig.run({"ngs-scene", "import", ".", "-o", "scene.json"}).exit_code == 0);
  rig.dir.write("0.json", R"({"ngs_prompts": 1, "width": 48, "height": 36, "boxes": [[12, 6, 36, 30]]})");
  test::refused(rig.run({"ngs-mask", "scene.json", "--prompts", "0.json", "-o", "made"}), 2,
                "matches the names of several views, cam0/0.png and cam1/0.png");
}

// ngs-scene orbit on a splat without photos, then the other tools on its renders instead of photos.

namespace {

using Json = nlohmann::json;

void run_tool(const test::TempDir& dir, std::vector<std::string> argv) {
  test::succeeded(test::run_tool(std::move(argv), dir.path()));
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
    dc[0] = i < ball ? 1.5f : 0.1f;
    dc[1] = i < ball ? -1.2f : 0.1f;
    dc[2] = i < ball ? -1.2f : 0.1f;
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
