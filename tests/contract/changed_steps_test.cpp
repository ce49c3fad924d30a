// What pipelines/ngs-gs.sh repeats in a second call, on the tiny scene with the built tools.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/chain_capture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture, test::run_script, test::times_of;

TEST_CASE("ngs-gs.sh runs only what changed") {
  const Capture capture;
  const std::string out = capture.out;
  const auto run = [&](std::vector<std::string> words,
                       std::vector<std::pair<std::string, std::string>> environment = {}) {
    return capture.run(std::move(words), std::move(environment));
  };
  test::succeeded(run({"--method", "flash"}));
  const auto before = times_of(out);

  SUBCASE("nothing, if nothing changed") {
    const test::ProcessResult second = test::succeeded(run({"--method", "flash", "-j", "1"}));
    CHECK(second.err == "the output: nothing has changed since the last call\n");
    CHECK(times_of(out) == before);
  }
  SUBCASE("the steps whose results were removed, and those that read them") {
    for (const char* name : {"background.ply", "masks", "metrics.json", "report.html"}) {
      CAPTURE(name);
      fs::remove_all(out + "/" + name);
      CHECK(run({"--method", "flash"}).exit_code == 0);
      CHECK(fs::exists(out + "/" + name));
    }
    CHECK(times_of(out)["labelled.ply"] == before.at("labelled.ply"));
  }
  SUBCASE("the optimisation and what follows it, if the method changed") {
    CHECK(run({"--method", "sa3d"}).exit_code == 0);
    auto after = times_of(out);
    CHECK(after["boundary.ply"] == before.at("boundary.ply"));
    CHECK(after["labelled.ply"] != before.at("labelled.ply"));
    CHECK(after["report.html"] != before.at("report.html"));
  }
  SUBCASE("everything, if a mask changed") {
    fs::copy_file(capture.dir.path() + "/my scene/masks/v0.png", capture.dir.path() + "/my scene/masks/v1.png",
                  fs::copy_options::overwrite_existing);
    test::succeeded(run({"--method", "flash"}));
    auto after = times_of(out);
    CHECK(after["boundary.ply"] != before.at("boundary.ply"));
    CHECK(after["metrics.json"] != before.at("metrics.json"));
  }
  SUBCASE("the optimisation, if a file named in its options changed") {
    const auto steps = [&](const char* text) {
      capture.dir.write("joint.json", text);
      CHECK(run({"--method", "flash"}, {{"JOINT_FLAGS", "--options joint.json"}}).exit_code == 0);
      std::ifstream file(out + "/reports/ngs-joint.json");
      return nlohmann::json::parse(file)["options"]["steps"].get<int>();
    };
    CHECK(steps("{\"steps\": 3}") == 3);
    CHECK(steps("{\"steps\": 14}") == 14);
    CHECK(times_of(out)["boundary.ply"] == before.at("boundary.ply"));
  }
  SUBCASE("the boundary and what follows it, if its flags changed") {
    CHECK(run({"--method", "flash"}, {{"VARIANCE_FLAGS", "--tau 0.4"}}).exit_code == 0);
    auto after = times_of(out);
    CHECK(after["scene.json"] == before.at("scene.json"));
    CHECK(after["boundary.ply"] != before.at("boundary.ply"));
    CHECK(after["labelled.ply"] != before.at("labelled.ply"));
  }
  SUBCASE("the scores, if a bound was added; it is not met in a third call either") {
    for (int call = 0; call < 2; ++call)
      CHECK(run({"--method", "flash"}, {{"EVAL_FLAGS", "--fail-below iou=1.01"}}).exit_code == 1);
    auto after = times_of(out);
    CHECK(after["labelled.ply"] == before.at("labelled.ply"));
    CHECK(after["metrics.json"] != before.at("metrics.json"));
    CHECK(after["report.html"] != before.at("report.html"));
  }
}

TEST_CASE("ngs-gs.sh --until stops after the step that writes the file, and fails if nothing was scored") {
  const Capture capture;
  const std::string out = capture.out + "/";
  const auto until = [&](const std::string& file) {
    return run_script(capture.dir.path(), {"my scene", "the output", "--method", "flash", "--until", file},
                      {{"SAMPLE_FLAGS", "--rows 8 --cols 8"}});
  };
  CHECK(until("labelled.ply").exit_code == 0);
  CHECK(fs::exists(out + "labelled.ply"));
  CHECK_FALSE(fs::exists(out + "field.ply"));
  CHECK_FALSE(fs::exists(out + "masks"));
  CHECK(until("field.ply").exit_code == 0);
  CHECK(fs::exists(out + "field.ply"));
  const test::ProcessResult unscored = until("metrics.json");
  CHECK(unscored.exit_code == 5);
  CHECK(unscored.err.find("scores need true masks") != std::string::npos);
  CHECK(fs::exists(out + "object.ply"));
  CHECK_FALSE(fs::exists(out + ".state/alone"));
  const auto before = times_of(capture.dir.path());
  CHECK(until("objects.zip").exit_code == 2);
  CHECK(times_of(capture.dir.path()) == before);
}

TEST_CASE("NGS_RUN stands before every call of a tool") {
  const Capture capture;
  capture.dir.write("each", "#!/bin/sh\necho $2 >> calls\nexec \"$@\"\n");
  fs::permissions(capture.dir.path() + "/each", fs::perms::owner_all);
  test::succeeded(run_script(capture.dir.path(), {"my scene", "the output", "--until", "boundary.ply"},
                             {{"NGS_RUN", "./each env"}}));
  CHECK(test::read_bytes(capture.dir.path() + "/calls") == "ngs-scene\nngs-variance\n");
}

TEST_CASE("ngs-gs.sh finds poses in the same places as ngs-scene") {
  for (const auto& [from, to] : {std::pair{"sparse", "colmap/sparse"}, {"transforms.json", "transforms_train.json"}}) {
    CAPTURE(to);
    const Capture capture;
    const std::string scene = capture.dir.path() + "/my scene/", moved = capture.dir.path() + "/moved";
    fs::rename(scene + from, moved);
    for (const char* other : {"sparse", "transforms.json", "cameras.json"}) fs::remove_all(scene + other);
    fs::create_directories(fs::path(scene + to).parent_path());
    fs::rename(moved, scene + to);
    test::succeeded(run_script(capture.dir.path(), {"my scene", "the output", "--until", "scene.json"}));
    CHECK(fs::exists(capture.out + "/scene.json"));
  }
}

TEST_CASE("ngs-gs.sh detects a changed photo in a folder that only the transforms file names") {
  const Capture capture;
  const std::string scene = capture.dir.path() + "/my scene/";
  fs::remove_all(scene + "sparse"), fs::remove(scene + "cameras.json");
  fs::rename(scene + "images", scene + "train photos");
  std::stringstream text;
  text << std::ifstream(scene + "transforms.json").rdbuf();
  std::string poses = text.str();
  for (std::size_t at = 0; (at = poses.find("images/", at)) != poses.npos;) poses.replace(at, 7, "train photos/");
  std::ofstream(scene + "transforms.json") << poses;
  const std::string out = capture.out;
  const auto run = [&] { return run_script(capture.dir.path(), {"my scene", "the output", "--until", "scene.json"}); };
  test::succeeded(run());
  const auto before = times_of(out);
  CHECK(run().exit_code == 0);
  CHECK(times_of(out) == before);
  fs::copy_file(scene + "train photos/v0.png", scene + "train photos/v1.png", fs::copy_options::overwrite_existing);
  CHECK(run().exit_code == 0);
  CHECK(times_of(out)["scene.json"] != before.at("scene.json"));
}

}  // namespace
}  // namespace ngs
