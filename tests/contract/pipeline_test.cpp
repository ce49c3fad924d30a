// pipelines/ngs-gs.sh on the tiny scene with the built tools.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ngs/io/image/image_file.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

const char* const kScript = NGS_SOURCE_DIR "/pipelines/ngs-gs.sh";

test::ProcessResult run_script(const std::string& folder, std::vector<std::string> arguments,
                               std::vector<std::pair<std::string, std::string>> environment = {}) {
  test::ProcessSpec spec;
  spec.argv = {kScript};
  spec.argv.insert(spec.argv.end(), arguments.begin(), arguments.end());
  spec.folder = folder;
  spec.environment = std::move(environment);
  spec.environment.emplace_back("NGS_BIN", NGS_TOOL_DIR);
  spec.environment.emplace_back("NGS_THREADS", "2");
  return test::run_process(spec);
}

std::map<std::string, fs::file_time_type> times_of(const std::string& folder) {
  std::map<std::string, fs::file_time_type> times;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().string().find("/.state/") == std::string::npos)
      times[fs::relative(entry.path(), folder).string()] = entry.last_write_time();
  return times;
}

struct Capture {
  test::TempDir dir;
  std::string out;
  Capture() {
    fs::create_directories(dir.path() + "/my scene");
    test::write_tiny_scene(dir.path() + "/my scene");
    fs::remove(dir.path() + "/my scene/scene.json");
    out = dir.path() + "/the output";
  }
  /// The tiny scene with spaces in both folder names, v2 held out.
  test::ProcessResult run(std::vector<std::string> further,
                          std::vector<std::pair<std::string, std::string>> environment = {}) const {
    further.insert(further.begin(), {"my scene", "the output", "--hold-out", "every:4:2", "--gt", "my scene/masks"});
    return run_script(dir.path(), further, std::move(environment));
  }
};

TEST_CASE("ngs-gs.sh writes every documented file, then reruns only what changed") {
  REQUIRE(fs::exists(NGS_TOOL_DIR "/ngs-joint"));
  const Capture capture;
  const test::ProcessResult first = capture.run({"--method", "flash"});
  INFO(first.err);
  REQUIRE(first.exit_code == 0);
  for (const char* name : {"scene.json", "boundary.ply", "labelled.ply", "object.ply", "background.ply", "masks/v2.png",
                           "metrics.json", "report.html", "reports/ngs-joint.json"}) {
    CAPTURE(name);
    CHECK(fs::exists(capture.out + "/" + name));
  }
  const auto before = times_of(capture.out);

  SUBCASE("nothing, if nothing changed") {
    const test::ProcessResult second = capture.run({"--method", "flash", "-q", "-j", "1"});
    CHECK(second.exit_code == 0);
    CHECK(second.err == "");
    CHECK(times_of(capture.out) == before);
  }
  SUBCASE("the optimisation and what follows it, if the method changed") {
    const test::ProcessResult second = capture.run({"--method", "sa3d"});
    CHECK(second.exit_code == 0);
    auto after = times_of(capture.out);
    CHECK(after["boundary.ply"] == before.at("boundary.ply"));
    CHECK(after["labelled.ply"] != before.at("labelled.ply"));
    CHECK(after["report.html"] != before.at("report.html"));
  }
  SUBCASE("everything, if a mask changed") {
    fs::copy_file(capture.dir.path() + "/my scene/masks/v0.png", capture.dir.path() + "/my scene/masks/v1.png",
                  fs::copy_options::overwrite_existing);
    const test::ProcessResult second = capture.run({"--method", "flash"});
    INFO(second.err);
    CHECK(second.exit_code == 0);
    auto after = times_of(capture.out);
    CHECK(after["boundary.ply"] != before.at("boundary.ply"));
    CHECK(after["metrics.json"] != before.at("metrics.json"));
  }
  SUBCASE("the scores, if a bound was added; returns 1 if it is not met") {
    const test::ProcessResult second = capture.run({"--method", "flash"}, {{"EVAL_FLAGS", "--fail-below iou=1.01"}});
    INFO(second.err);
    CHECK(second.exit_code == 1);
    auto after = times_of(capture.out);
    CHECK(after["labelled.ply"] == before.at("labelled.ply"));
    CHECK(after["metrics.json"] != before.at("metrics.json"));
  }
}

TEST_CASE("ngs-gs.sh renders masks at the photos' size if the working size does not divide it") {
  const Capture capture;
  const test::ProcessResult result = capture.run({"--image-scale", "0.3", "--method", "flash"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(io::read_image_size(capture.out + "/masks/v2.png") == io::ImageSize{48, 36});  // 14 / 0.3 is 47
}

TEST_CASE("ngs-gs.sh prints the commands in a dry run and writes nothing") {
  const Capture capture;
  const test::ProcessResult result = capture.run({"-n", "--steps", "5", "--quality", "draft"});
  INFO(result.err);
  CHECK(result.exit_code == 0);
  CHECK(result.out.find("ngs-variance ./scene.json -o ./boundary.ply") != std::string::npos);
  CHECK(result.out.find("--quality draft") != std::string::npos);
  CHECK(result.out.find("--steps 5") != std::string::npos);
  CHECK(times_of(capture.out).empty());
}

TEST_CASE("ngs-gs.sh passes --device only to tools with a CUDA path") {
  const Capture capture;
  const auto given = [&](std::vector<std::string> further) {  // tool -> true if its command has the option
    further.insert(further.end(), {"-n", "--artifacts", "all", "--device", "cuda"});
    const test::ProcessResult result = capture.run(further);
    REQUIRE(result.exit_code == 0);
    std::map<std::string, bool> tools;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("ngs-"))
        tools[line.substr(0, line.find(' '))] = line.find(" --device cuda ") != std::string::npos;
    return tools;
  };
  std::map<std::string, bool> expected;
  for (const char* tool : {"ngs-scene", "ngs-sample", "ngs-extract", "ngs-eval", "ngs-report"}) expected[tool] = false;
  for (const char* tool : {"ngs-variance", "ngs-rbf", "ngs-joint", "ngs-render"}) expected[tool] = true;
  CHECK(given({}) == expected);
  for (const char* method : {"ngs", "ng-gs"}) {
    CAPTURE(method);
    CHECK(given({"--method", method}) == expected);
  }
  expected["ngs-joint"] = false;
  CHECK(given({"--method", "flash"}) == expected);

  // If the device does not exist, the first tool with a CUDA path fails.
  const test::ProcessResult result = capture.run({"--device", "cuda"});
  if (result.exit_code != 0) CHECK(result.err.find("no CUDA path") == std::string::npos);
  CHECK(fs::exists(capture.out + "/scene.json"));
}

TEST_CASE("ngs-gs.sh returns the exit code of the failed tool") {
  const Capture capture;
  fs::resize_file(capture.dir.path() + "/my scene/model.ply", 300);
  const test::ProcessResult result = capture.run({});
  CHECK(result.exit_code == 3);
  CHECK(result.err.find("model.ply") != std::string::npos);
}

TEST_CASE("ngs-gs.sh rejects invalid arguments") {
  const test::TempDir dir;
  CHECK(run_script(dir.path(), {}).exit_code == 2);
  CHECK(run_script(dir.path(), {"nowhere", "out"}).exit_code == 3);
  CHECK(run_script(dir.path(), {".", "out", "--image-scale", "none"}).exit_code == 2);
  const test::ProcessResult empty = run_script(dir.path(), {".", "out"});
  CHECK(empty.exit_code == 3);
  CHECK(empty.err.find("no poses found") != std::string::npos);
}

TEST_CASE("ngs-gs.sh stops at the artifact of --until, and lists the artifacts for an unknown one") {
  const Capture capture;
  const test::ProcessResult unknown = capture.run({"--until", "boundary.png"});
  CHECK(unknown.exit_code == 2);
  CHECK(unknown.err.find("--until boundary.png: expected scene.json") != std::string::npos);
  CHECK(capture.run({"--method", "flash", "--until", "masks"}).exit_code == 0);
  CHECK(fs::exists(capture.out + "/masks/v2.png"));
  CHECK_FALSE(fs::exists(capture.out + "/metrics.json"));
  const test::ProcessResult unscored =
      run_script(capture.dir.path(), {"my scene", "other", "--method", "flash", "--until", "metrics.json"});
  CHECK(unscored.exit_code == 5);
  CHECK(unscored.err.find("nothing was scored") != std::string::npos);
}

TEST_CASE("ngs-gs.sh computes the field if a stage reads it or it is requested, else reports that it is not needed") {
  const Capture capture;
  const auto has_field = [&] {
    return fs::exists(capture.out + "/queries.ply") && fs::exists(capture.out + "/field.ply");
  };
  const test::ProcessResult without = capture.run({"--method", "flash", "--until", "labelled.ply"});
  REQUIRE(without.exit_code == 0);
  CHECK_FALSE(has_field());
  CHECK(without.err.find("queries.ply and field.ply are not needed") != std::string::npos);
  const auto bytes = [&] { return test::read_bytes(capture.out + "/labelled.ply"); };
  const std::string labelled = bytes();
  SUBCASE("requested") {
    CHECK(capture.run({"--method", "flash", "--until", "labelled.ply", "--artifacts", "all"}).exit_code == 0);
    CHECK(has_field());
    CHECK(bytes() == labelled);
  }
  SUBCASE("as a target") {
    CHECK(capture.run({"--method", "flash", "--until", "field.ply"}).exit_code == 0);
    CHECK(has_field());
  }
  SUBCASE("read") {
    const test::ProcessResult plan = capture.run({"--effect", "nerf=on", "-n"});
    CHECK(plan.out.find("--field") != std::string::npos);
    CHECK(plan.out.find("ngs-rbf") != std::string::npos);
    CHECK(capture.run({"--method", "ng-gs", "-n"}).out.find("ngs-rbf") != std::string::npos);
    CHECK(capture.run({"--method", "flash", "-n"}).out.find("ngs-rbf") == std::string::npos);
  }
  CHECK(capture.run({"--artifacts", "some"}).exit_code == 2);
}

TEST_CASE("ngs-gs.sh prints a failure once: the message of the tool, not that of make") {
  const Capture capture;
  fs::remove_all(capture.dir.path() + "/my scene/masks");
  fs::create_directories(capture.dir.path() + "/my scene/masks");
  const test::ProcessResult failed = run_script(capture.dir.path(), {"my scene", "other", "--method", "flash"});
  CHECK(failed.exit_code >= 3);
  CHECK(failed.err.find("error: ") != std::string::npos);
  CHECK(failed.err.find("make") == std::string::npos);
}

TEST_CASE("ngs-gs.sh recreates files that were removed from the output folder") {
  const Capture capture;
  const std::vector<std::string> all{"--method", "flash", "--artifacts", "all"};
  REQUIRE(capture.run(all).exit_code == 0);
  for (const char* name : {"background.ply", "masks", "masks/v2.png", "metrics.json", "field.ply"}) {
    CAPTURE(name);
    fs::remove_all(capture.out + "/" + name);
    CHECK(capture.run(all).exit_code == 0);
    CHECK(fs::exists(capture.out + "/" + name));
  }
  const auto before = times_of(capture.out);
  CHECK(capture.run(all).exit_code == 0);
  CHECK(times_of(capture.out) == before);
}

TEST_CASE("ngs-gs.sh scores against input masks as ngs-scene reads them, or not at all") {
  const Capture capture;
  const std::string masks = capture.dir.path() + "/my scene/masks/";
  const auto run = [&](const char* scene_flags, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"my scene", "the output", "--hold-out", "every:4:2", "--method", "flash"});
    return run_script(capture.dir.path(), more, {{"SCENE_FLAGS", scene_flags}});
  };
  const auto iou = [&] {
    std::ifstream file(capture.out + "/metrics.json");
    return nlohmann::json::parse(file)["mean"]["iou"].get<double>();
  };
  SUBCASE("label maps") {
    const test::ProcessResult result = run("--mask-mode label", {"--masks", "my scene/labels"});
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(iou() > 0.8);
  }
  SUBCASE("label maps with void pixels") {
    for (const fs::directory_entry& file : fs::directory_iterator(capture.dir.path() + "/my scene/labels")) {
      const io::RawMask labels = io::read_mask_raw(file.path().string(), io::Palette::kIndices);
      ImageU8 with_void(labels.width_px, labels.height_px, 1);
      for (std::size_t p = 0; p < with_void.data.size(); ++p)
        with_void.data[p] = p < 3 * std::size_t(labels.width_px) ? 255 : std::uint8_t(labels.data[p]);
      io::write_png(file.path().string(), with_void);
    }
    const test::ProcessResult result = run("--mask-mode label --void-id 255", {"--masks", "my scene/labels"});
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    std::ifstream file(capture.out + "/metrics.json");
    const nlohmann::json metrics = nlohmann::json::parse(file);
    for (const nlohmann::json& view : metrics["views"])
      CHECK(view["counts"]["void_px"] == 3 * view["width_px"].get<int>());
  }
  SUBCASE("inverted masks") {
    for (const fs::directory_entry& file : fs::directory_iterator(masks)) {
      const io::RawMask mask = io::read_mask_raw(file.path().string(), io::Palette::kMask);
      ImageU8 inverted(mask.width_px, mask.height_px, 1);
      for (std::size_t p = 0; p < inverted.data.size(); ++p) inverted.data[p] = mask.data[p] > 0 ? 0 : 255;
      io::write_png(file.path().string(), inverted);
    }
    const test::ProcessResult result = run("--mask-invert");
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(result.err.find("the input masks are inverted: nothing is scored") != std::string::npos);
    CHECK_FALSE(fs::exists(capture.out + "/metrics.json"));
    CHECK(fs::exists(capture.out + "/report.html"));
  }
  SUBCASE("no held-out view has a mask") {
    fs::remove(masks + "v2.png"), fs::remove(masks + "v6.png");
    const test::ProcessResult result = run("");
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(result.err.find("no held-out view has an input mask: nothing is scored") != std::string::npos);
    CHECK(fs::exists(capture.out + "/report.html"));
    const auto before = times_of(capture.out);
    CHECK(run("").exit_code == 0);
    CHECK(times_of(capture.out) == before);
  }
}

TEST_CASE("ngs-gs.sh finds poses in the same places as ngs-scene") {
  for (const auto& [from, to] : {std::pair{"sparse", "colmap/sparse"}, {"transforms.json", "transforms_train.json"}}) {
    CAPTURE(to);
    const Capture capture;
    const std::string scene = capture.dir.path() + "/my scene/", kept = capture.dir.path() + "/kept";
    fs::rename(scene + from, kept);
    for (const char* other : {"sparse", "transforms.json", "cameras.json"}) fs::remove_all(scene + other);
    fs::create_directories(fs::path(scene + to).parent_path());
    fs::rename(kept, scene + to);
    const test::ProcessResult result =
        run_script(capture.dir.path(), {"my scene", "the output", "--until", "scene.json"});
    INFO(result.err);
    CHECK(result.exit_code == 0);
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
  const auto run = [&] { return run_script(capture.dir.path(), {"my scene", "the output", "--until", "scene.json"}); };
  const test::ProcessResult first = run();
  INFO(first.err);
  REQUIRE(first.exit_code == 0);
  const auto before = times_of(capture.out);
  CHECK(run().exit_code == 0);
  CHECK(times_of(capture.out) == before);
  fs::copy_file(scene + "train photos/v0.png", scene + "train photos/v1.png", fs::copy_options::overwrite_existing);
  CHECK(run().exit_code == 0);
  CHECK(times_of(capture.out)["scene.json"] != before.at("scene.json"));
}

TEST_CASE("ngs-gs.sh rejects an output folder where it would replace masks that it did not render") {
  const Capture capture;
  const std::string scene = capture.dir.path() + "/my scene", out = capture.out;
  const auto refused = [&](std::vector<std::string> arguments, const std::string& because) {
    CAPTURE(arguments);
    const auto before = times_of(capture.dir.path());
    const test::ProcessResult result = run_script(capture.dir.path(), arguments);
    INFO(result.err);
    CHECK(result.exit_code == 2);
    CHECK(result.err.find(because) != std::string::npos);
    CHECK(result.err.find("hint: ") != std::string::npos);
    CHECK(times_of(capture.dir.path()) == before);
  };
  SUBCASE("the scene, by any name") {
    refused({"my scene", "my scene", "--hold-out", "every:4:2"}, "is also the input");
    fs::create_directory_symlink("my scene", capture.dir.path() + "/link");
    refused({"my scene", "link", "-n"}, "is also the input");
    refused({"my scene", "my scene/masks"}, "is also the input");
  }
  SUBCASE("masks or truth in OUT_DIR/masks, or below it") {
    fs::create_directories(out + "/masks");
    fs::copy(scene + "/masks", out + "/masks/cup");
    refused({"my scene", "the output", "--masks", "the output/masks"}, "contains the input");
    refused({"my scene", "the output", "--gt", "the output/masks/cup"}, "contains the input");
  }
  SUBCASE("a model that the result would replace") {
    REQUIRE(capture.run({"--method", "flash"}).exit_code == 0);
    refused({"my scene", "the output", "--model", "the output/background.ply"}, "is the input model");
  }
  SUBCASE("masks added next to the rendered ones") {
    REQUIRE(capture.run({"--method", "flash"}).exit_code == 0);
    fs::copy(scene + "/masks/v0.png", out + "/masks/mine.png");
    refused({"my scene", "the output", "--method", "sa3d"}, "contains mine.png, which no run has rendered");
  }
  SUBCASE("masks without a record, until they are moved away") {
    fs::create_directories(out);
    fs::copy(scene + "/masks", out + "/masks");
    refused({"my scene", "the output"}, "no run has rendered");
    test::ProcessSpec make;
    make.argv = {"make",
                 "-f",
                 NGS_SOURCE_DIR "/pipelines/experiment.mk",
                 "SCENE=my scene",
                 "OUT=the-output",
                 "the-output/scene.json"};
    make.folder = capture.dir.path();
    make.environment = {{"NGS_BIN", NGS_TOOL_DIR}};
    fs::rename(out, capture.dir.path() + "/the-output");
    const test::ProcessResult direct = test::run_process(make);
    CHECK(direct.exit_code != 0);
    CHECK(direct.err.find("no run has rendered") != std::string::npos);
    fs::rename(capture.dir.path() + "/the-output/masks", out);
    CHECK(test::run_process(make).exit_code == 0);
  }
}

}  // namespace
}  // namespace ngs
