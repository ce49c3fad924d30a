// pipelines/experiment.mk on the tiny scene with the built tools.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/chain_capture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture, test::run_make, test::times_of;

TEST_CASE("experiment.mk runs only what changed") {
  const Capture capture;
  const std::string out = capture.dir.path() + "/out";
  const auto make = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"HOLD_OUT=every:4:2", "GT=my scene/masks"});
    return run_make(capture.dir.path(), words);
  };
  const test::ProcessResult first = make({"METHOD=flash"});
  INFO(first.err);
  REQUIRE(first.exit_code == 0);
  for (const char* name : {"scene.json", "boundary.ply", "labelled.ply", "object.ply", "background.ply", "masks/v2.png",
                           "metrics.json", "metrics_input.json", "report.html", "reports/ngs-joint.json"}) {
    CAPTURE(name);
    CHECK(fs::exists(out + "/" + name));
  }
  const auto before = times_of(out);

  SUBCASE("nothing, if nothing changed") {
    const test::ProcessResult second = make({"METHOD=flash", "UNKEYED_FLAGS=-q -j 1"});
    CHECK(second.exit_code == 0);
    CHECK(second.err == "");
    CHECK(times_of(out) == before);
  }
  SUBCASE("the optimisation and what follows it, if the method changed") {
    CHECK(make({"METHOD=sa3d"}).exit_code == 0);
    auto after = times_of(out);
    CHECK(after["boundary.ply"] == before.at("boundary.ply"));
    CHECK(after["labelled.ply"] != before.at("labelled.ply"));
    CHECK(after["report.html"] != before.at("report.html"));
  }
  SUBCASE("everything, if a mask changed") {
    fs::copy_file(capture.dir.path() + "/my scene/masks/v0.png", capture.dir.path() + "/my scene/masks/v1.png",
                  fs::copy_options::overwrite_existing);
    const test::ProcessResult second = make({"METHOD=flash"});
    INFO(second.err);
    CHECK(second.exit_code == 0);
    auto after = times_of(out);
    CHECK(after["boundary.ply"] != before.at("boundary.ply"));
    CHECK(after["metrics.json"] != before.at("metrics.json"));
  }
  SUBCASE("the optimisation, if a file named in its options changed") {
    const auto steps = [&](const char* text) {
      capture.dir.write("joint.json", text);
      CHECK(make({"METHOD=flash", "JOINT_FLAGS=--options joint.json"}).exit_code == 0);
      std::ifstream file(out + "/reports/ngs-joint.json");
      return nlohmann::json::parse(file)["options"]["steps"].get<int>();
    };
    CHECK(steps("{\"steps\": 3}") == 3);
    CHECK(steps("{\"steps\": 14}") == 14);
    CHECK(times_of(out)["boundary.ply"] == before.at("boundary.ply"));
  }
  SUBCASE("the scores, if a bound was added; make fails if it is not met") {
    const test::ProcessResult second = make({"METHOD=flash", "EVAL_FLAGS=--fail-below iou=1.01"});
    INFO(second.err);
    CHECK(second.exit_code != 0);
    CHECK(second.err.find("a bound of --fail-below was not met") != std::string::npos);
    auto after = times_of(out);
    CHECK(after["labelled.ply"] == before.at("labelled.ply"));
    CHECK(after["metrics.json"] != before.at("metrics.json"));
    CHECK(after["report.html"] != before.at("report.html"));
  }
}

TEST_CASE("experiment.mk writes the artifact given as target, and fails if nothing was scored") {
  const Capture capture;
  const std::string out = capture.dir.path() + "/out/";
  CHECK(run_make(capture.dir.path(), {"METHOD=flash", "out/labelled.ply"}).exit_code == 0);
  CHECK(fs::exists(out + "labelled.ply"));
  CHECK_FALSE(fs::exists(out + "field.ply"));
  CHECK_FALSE(fs::exists(out + "masks"));
  CHECK(run_make(capture.dir.path(), {"METHOD=flash", "out/field.ply"}).exit_code == 0);
  CHECK(fs::exists(out + "field.ply"));
  const test::ProcessResult unscored = run_make(capture.dir.path(), {"METHOD=flash", "out/metrics.json"});
  CHECK(unscored.exit_code != 0);
  CHECK(unscored.err.find("nothing was scored") != std::string::npos);
  CHECK(fs::exists(out + "object.ply"));
  CHECK_FALSE(fs::exists(out + ".state/alone"));
}

TEST_CASE("experiment.mk recreates files that were removed from the output folder") {
  const Capture capture;
  const std::string out = capture.dir.path() + "/out";
  const auto make = [&] {
    return run_make(capture.dir.path(), {"METHOD=flash", "ARTIFACTS=all", "HOLD_OUT=every:4:2"}).exit_code;
  };
  REQUIRE(make() == 0);
  for (const char* name : {"background.ply", "masks", "metrics.json", "field.ply"}) {
    CAPTURE(name);
    fs::remove_all(out + "/" + name);
    CHECK(make() == 0);
    CHECK(fs::exists(out + "/" + name));
  }
  const auto before = times_of(out);
  CHECK(make() == 0);
  CHECK(times_of(out) == before);
}

TEST_CASE("experiment.mk finds poses in the same places as ngs-scene") {
  for (const auto& [from, to] : {std::pair{"sparse", "colmap/sparse"}, {"transforms.json", "transforms_train.json"}}) {
    CAPTURE(to);
    const Capture capture;
    const std::string scene = capture.dir.path() + "/my scene/", moved = capture.dir.path() + "/moved";
    fs::rename(scene + from, moved);
    for (const char* other : {"sparse", "transforms.json", "cameras.json"}) fs::remove_all(scene + other);
    fs::create_directories(fs::path(scene + to).parent_path());
    fs::rename(moved, scene + to);
    const test::ProcessResult result = run_make(capture.dir.path(), {"out/scene.json"});
    INFO(result.err);
    CHECK(result.exit_code == 0);
    CHECK(fs::exists(capture.dir.path() + "/out/scene.json"));
  }
}

TEST_CASE("experiment.mk detects a changed photo in a folder that only the transforms file names") {
  const Capture capture;
  const std::string scene = capture.dir.path() + "/my scene/";
  fs::remove_all(scene + "sparse"), fs::remove(scene + "cameras.json");
  fs::rename(scene + "images", scene + "train photos");
  std::stringstream text;
  text << std::ifstream(scene + "transforms.json").rdbuf();
  std::string poses = text.str();
  for (std::size_t at = 0; (at = poses.find("images/", at)) != poses.npos;) poses.replace(at, 7, "train photos/");
  std::ofstream(scene + "transforms.json") << poses;
  const std::string out = capture.dir.path() + "/out";
  const auto run = [&] { return run_make(capture.dir.path(), {"out/scene.json"}); };
  const test::ProcessResult first = run();
  INFO(first.err);
  REQUIRE(first.exit_code == 0);
  const auto before = times_of(out);
  CHECK(run().exit_code == 0);
  CHECK(times_of(out) == before);
  fs::copy_file(scene + "train photos/v0.png", scene + "train photos/v1.png", fs::copy_options::overwrite_existing);
  CHECK(run().exit_code == 0);
  CHECK(times_of(out)["scene.json"] != before.at("scene.json"));
}

}  // namespace
}  // namespace ngs
