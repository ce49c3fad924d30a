// The data-set scripts of pipelines/ on data sets of one tiny scene each, with the layout of the real ones.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ngs/io/image/image_file.h"
#include "support/chain_capture.h"
#include "support/schema_check.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct DataSet : test::ChainCapture {
  DataSet() : ChainCapture("tiny") {}
  void copy(const std::string& from, const std::string& to) const {
    fs::create_directories(fs::path(path(to)).parent_path());
    fs::copy(path("tiny/" + from), path(to), fs::copy_options::recursive);
  }
};

/// One task of NVOS: the tiny scene, with view v2 as the target.
void write_fern(const DataSet& data) {
  data.copy("images", "llff/fern/images");
  data.copy("model.ply", "llff/fern/point_cloud.ply");
  data.copy("masks/v2.png", "nvos/masks/fern/IMG_4027_mask.png");
  fs::rename(data.path("llff/fern/images/v2.png"), data.path("llff/fern/images/IMG_4027.png"));
  std::string poses = data.bytes("tiny/transforms.json");
  REQUIRE(poses.find("v2.png") != poses.npos);
  data.dir.write("llff/fern/transforms.json", poses.replace(poses.find("v2.png"), 6, "IMG_4027.png"));
}

TEST_CASE("nvos.sh makes the input masks from scribbles on the reference view") {
  const DataSet data;
  write_fern(data);
  data.copy("images/v0.png", "nvos/reference_image/fern/v0.png");
  ImageU8 stroke(48, 36, 1);
  for (int x = 20; x < 28; ++x) stroke.at(x, 18) = 255;
  io::write_png(data.dir.file("nvos/scribbles/fern/pos_0_fern.png"), stroke);
  stroke = ImageU8(48, 36, 1);
  for (int x = 0; x < 48; ++x) stroke.at(x, 2) = 255;
  io::write_png(data.dir.file("nvos/scribbles/fern/neg_0_fern.png"), stroke);
  test::succeeded(data.script("nvos.sh", {"nvos", "llff", "scribbles", "out", "--method", "flash", "-q"}));
  CHECK(data.json("out/fern/metrics.json")["mean"]["iou"].get<double>() > 0.8);
  CHECK(data.has("out/fern.scribbles/masks/v1.png"));
}

TEST_CASE("nvos.sh scores the target view of existing tasks and lists missing tasks") {
  const DataSet data;
  write_fern(data);
  data.copy("masks", "masks/fern");
  fs::rename(data.path("masks/fern/v2.png"), data.path("masks/fern/IMG_4027.png"));
  const test::ProcessResult result =
      test::succeeded(data.script("nvos.sh", {"nvos", "llff", "masks", "out", "--method", "flash", "-q"}));
  CHECK(result.err.find("trex skipped") != std::string::npos);
  const Json metrics = data.json("out/fern/metrics.json");
  REQUIRE(metrics["views"].size() == 1);
  CHECK(metrics["views"][0]["view"] == "IMG_4027_mask");
  CHECK(metrics["mean"]["iou"].get<double>() > 0.8);
  CHECK(data.json("out/summary.json")["result"]["mean_over_runs"]["iou"] == metrics["mean"]["iou"]);
  CHECK(data.has("out/report.html"));
  // A score below the bound makes the script fail, but stays in the mean.
  fs::remove(data.path("out/summary.json"));
  test::refused(data.script("nvos.sh", {"nvos", "llff", "masks", "out", "--method", "flash", "-q"},
                            {{"EVAL_FLAGS", "--fail-below iou=1.01"}}),
                1, "a bound of --fail-below was not met");
  CHECK(data.json("out/summary.json")["result"]["means"].size() == 1);
  const Json scene = data.json("out/fern/scene.json");
  for (const Json& view : scene["views"])
    CHECK((view["split"] == "held-out") == (view["name"].get<std::string>().find("IMG_4027") != std::string::npos));
}

TEST_CASE("lerf-mask.sh scores each prompt and averages over prompts and scenes") {
  const DataSet data;
  data.copy("images", "lerf/ramen/images");
  data.copy("transforms.json", "lerf/ramen/transforms.json");
  data.copy("model.ply", "lerf/ramen/point_cloud.ply");
  for (const char* view : {"v2", "v4"})
    data.copy(std::string("masks/") + view + ".png", std::string("lerf/ramen/test_mask/") + view + "/red ball.png");
  data.copy("masks", "masks/ramen/red ball");

  const test::ProcessResult result =
      test::succeeded(data.script("lerf-mask.sh", {"lerf", "masks", "out", "--method", "flash", "-q"}));
  CHECK(data.json("out/ramen/red ball/metrics.json")["views"].size() == 2);
  CHECK(result.err.find("mean over 1 scenes: biou") != std::string::npos);
}

/// pose/N.txt: camera -> world in OpenCV axes, from the OpenGL axes of transforms.json.
void write_scannet_poses(const DataSet& data) {
  const Json transforms = Json::parse(data.bytes("tiny/transforms.json"));
  int index = 0;
  for (const Json& frame : transforms["frames"]) {
    std::string text;
    for (const Json& row : frame["transform_matrix"])
      for (int c = 0; c < 4; ++c)
        text += std::to_string((c == 1 || c == 2 ? -1 : 1) * row[std::size_t(c)].get<double>()) + (c == 3 ? "\n" : " ");
    data.dir.write("scans/scene0/pose/" + std::to_string(index) + ".txt", text);
    const std::string name = fs::path(frame["file_path"].get<std::string>()).stem().string();
    data.copy("images/" + name + ".png", "scans/scene0/color/" + std::to_string(index) + ".jpg");
    data.copy("labels/" + name + ".png", "scans/scene0/instance-filt/" + std::to_string(index) + ".png");
    ++index;
  }
  data.dir.write("scans/scene0/pose/99.txt",
                 "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n0 0 0 1\n");
  const Json& k = transforms.contains("fl_x") ? transforms : transforms["frames"][0];
  const auto value = [&](const char* key) { return std::to_string(k[key].get<double>()); };
  data.dir.write(
      "scans/scene0/intrinsic/intrinsic_color.txt",
      value("fl_x") + " 0 " + value("cx") + " 0\n0 " + value("fl_y") + " " + value("cy") + " 0\n0 0 1 0\n0 0 0 1\n");
}

TEST_CASE("scannet.sh turns poses into a capture and scores instances of label maps") {
  const DataSet data;
  write_scannet_poses(data);
  data.copy("model.ply", "scans/scene0/point_cloud/iteration_30000/point_cloud.ply");  // layout of the Inria trainer
  const test::ProcessResult result =
      test::succeeded(data.script("scannet.sh", {"scans", "out", "--object-id", "7", "--method", "flash", "-q"}));
  CHECK(result.err.find("frame 99 has no finite pose") != std::string::npos);
  const Json metrics = data.json("out/scene0/run/metrics.json");
  REQUIRE(metrics["objects"].size() == 1);
  CHECK(metrics["objects"][0]["object"] == "7");
  CHECK(metrics["mean"]["iou"].get<double>() > 0.8);
}

TEST_CASE("ablation.mk compares the full method with its variants and omits failed ones") {
  const DataSet data;
  const test::ProcessResult result = test::succeeded(
      data.make("ablation.mk", {"SCENE=tiny", "OUT=out", "EFFECTS=cont nonsense", "TAUS=0.5", "SIGMAS=2", "KS=4",
                                "ARGS=--steps 2 --hold-out every:4:2 --gt tiny/masks"}));
  CHECK(result.err.find("variant without-nonsense failed, left out") != std::string::npos);
  const Json means = data.json("out/summary.json")["result"]["means"];
  REQUIRE(means.size() == 5);
  CHECK(means[1]["run"] == "without-cont");
  CHECK(means[2]["run"] == "tau-0.5");
  CHECK(data.json("out/sigma-2/reports/ngs-joint.json")["options"]["width_factor"] == 2);
  CHECK(data.json("out/K-4/reports/ngs-rbf.json")["options"]["neighbours"] == 4);
  CHECK(data.json("out/tau-0.5/reports/ngs-variance.json")["options"]["tau"] == 0.5);
}

TEST_CASE("removed-views.sh scores removed and remaining views") {
  const DataSet data;
  const std::string script = NGS_SOURCE_DIR "/tests/bench/removed-views.sh";
  const std::string folder = data.path("recipes");  // there is no folder `tiny`, so the recipe is used
  fs::create_directories(folder);
  const test::Words runs{script, "--run", "flash=--method flash", "--run", "short=--method bce --steps 2"};
  const test::ProcessResult result = test::succeeded(test::run_process(
      test::script_spec(folder, test::joined(runs, test::split("-o out --seeds 2 --novel --fit-steps 200 tiny")))));
  const auto lines = std::count(result.out.begin(), result.out.end(), '\n');
  CHECK(lines == 2 * 2 * 3 + 2 * 3);  // runs, seeds and scores; then means of runs and scores
  for (const char* score : {"transductive", "inductive", "novel"}) {
    CHECK(result.out.find("tiny\tevery:4:2\tshort\t1\t" + std::string(score)) != std::string::npos);
    CHECK(result.out.find("tiny\tmean\tflash\t-\t" + std::string(score)) != std::string::npos);
  }
  const auto views_of = [&](const char* score) {
    return data.json("recipes/out/tiny/every:4:2/" + std::string(score) + "/scene.json")["views"].size();
  };
  CHECK(views_of("inductive") < views_of("transductive"));
  // No file of a removed view remains.
  for (const char* score : {"inductive", "novel"}) {
    CHECK(views_of(score) == views_of("inductive"));
    for (const auto& view : data.json("recipes/out/tiny/every:4:2/" + std::string(score) + "/scene.json")["views"])
      CHECK(view["split"] == "train");
  }
  // The splat of the novel score was not trained on these views either, and is scored at their cameras.
  for (const auto& [score, splat] :
       {std::pair{"inductive", "capture/point_cloud.ply"}, {"novel", "novel.ply"}, {"novel-whole", "novel.ply"}})
    CHECK(data.json("recipes/out/tiny/every:4:2/" + std::string(score) + "/scene.json")["model"] ==
          "../" + std::string(splat));
  CHECK(data.bytes("recipes/out/tiny/every:4:2/novel.ply") != data.bytes("recipes/out/tiny/capture/point_cloud.ply"));
  const test::Words bad_split{script, "--split", "every:4", "tiny"};
  CHECK(test::run_process(test::script_spec(folder, bad_split)).exit_code == 2);
}

TEST_CASE("work-precision.mk plots its points with their frontier, and keeps failed points") {
  const DataSet data;
  test::succeeded(data.make("work-precision.mk", {"SCENE=tiny", "OUT=out", "GT=tiny/masks", "REPEATS=2", "STEPS=2",
                                                  "POINTS=method@flash method@nonsense steps@2 views@2 views@9"}));
  const auto schema = [](const char* name) {
    return nlohmann::json::parse(test::read_bytes(std::string(NGS_SOURCE_DIR "/data-schema/") + name));
  };
  const Json points = data.json("out/points.json");
  CHECK(test::schema_violations(schema("work-precision.schema.json"), points) == "");
  REQUIRE(points["points"].size() == 5);
  CHECK(points["points"][0]["setting"] == "flash");
  CHECK(points["points"][0]["frontier"] == true);
  CHECK(points["points"][0]["runs"].size() == 2);
  CHECK(points["points"][0]["score"]["min"] == points["points"][0]["score"]["max"]);  // deterministic
  CHECK(points["points"][1]["failed"] == true);
  CHECK(points["points"][1]["runs"][0]["exit_code"] == 2);
  CHECK(points["once_cpu_s"].contains("views@2"));
  CHECK(points["points"][4]["setting"] == "9");  // no view has a mask: even the evidence fails
  CHECK(points["points"][4]["runs"][0]["exit_code"] == 4);
  Json numerical = data.json("out/numerical.json");
  CHECK(test::schema_violations(schema("numerical.schema.json"), numerical) == "");
  CHECK(points["numerical"] == numerical);
  numerical["points"][0]["error"] = nullptr;
  CHECK(test::schema_violations(schema("numerical.schema.json"), numerical) != "");
  std::istringstream trace(data.bytes("out/points/steps@2/1/trace.jsonl"));
  int lines = 0;
  for (std::string line; std::getline(trace, line); ++lines)
    CHECK(test::schema_violations(schema("trace.schema.json"), nlohmann::json::parse(line)) == "");
  CHECK(lines == 3);
  const std::string page = data.bytes("out/report.html"), csv = data.bytes("out/points.csv");
  CHECK(page.find("method@nonsense") != std::string::npos);
  CHECK(page.find("://") == std::string::npos);
  CHECK(page.find("<script") == std::string::npos);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 10);

  // A removed point and one new point are computed; points of other settings are not mixed with them.
  fs::remove_all(data.path("out/points/method@flash/2"));
  const auto again = [&](const std::string& setting) {
    return data.make("work-precision.mk", {"SCENE=tiny", "OUT=out", "GT=tiny/masks", "REPEATS=2", setting,
                                           "POINTS=method@flash method@sa3d"});
  };
  CHECK(again("STEPS=2").exit_code == 0);
  CHECK(data.has("out/points/method@flash/2/done"));
  CHECK(data.has("out/points/method@sa3d/1/done"));
  const test::ProcessResult mixed = again("STEPS=3");
  CHECK(mixed.exit_code != 0);
  CHECK(mixed.err.find("contains points with other settings: STEPS=2") != std::string::npos);
}

}  // namespace
}  // namespace ngs
