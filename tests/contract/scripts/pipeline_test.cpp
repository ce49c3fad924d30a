// pipelines/ngs-gs.sh on the tiny scene with the built tools.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "ngs/io/image/image_file.h"
#include "support/chain_capture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::ChainCapture, test::times_of;

TEST_CASE("ngs-gs.sh writes every documented file, and exits with 1 if a bound of --fail-below is not met") {
  REQUIRE(fs::exists(NGS_TOOL_DIR "/ngs-joint"));
  const ChainCapture capture;
  test::succeeded(capture.run({"--method", "flash"}));
  for (const char* name :
       {"scene.json", "boundary.ply", "labelled.ply", "object.ply", "background.ply", "masks/v2.png", "metrics.json",
        "metrics_input.json", "report.html", "reports/ngs-joint.json", "reports/ngs-joint.sh"}) {
    CAPTURE(name);
    CHECK(fs::exists(capture.out + "/" + name));
  }
  CHECK_FALSE(fs::exists(capture.out + "/masks/v0.png"));
  const test::ProcessResult below = capture.run({"--method", "flash"}, {{"EVAL_FLAGS", "--fail-below iou=1.01"}});
  INFO(below.err);
  CHECK(below.exit_code == 1);
  CHECK(fs::exists(capture.out + "/report.html"));
}

TEST_CASE("ngs-gs.sh leaves no result of an earlier call with other options") {
  const ChainCapture capture;
  REQUIRE(capture.run({"--steps", "2", "--artifacts", "all"}).exit_code == 0);
  CHECK(fs::exists(capture.out + "/trace.jsonl"));
  REQUIRE(capture.ngs_gs({"my scene", "the output", "--method", "flash"}).exit_code == 0);
  for (const char* name : {"trace.jsonl", "field.ply", "metrics.json", "reports/ngs-rbf.json"}) {
    CAPTURE(name);
    CHECK_FALSE(fs::exists(capture.out + "/" + name));
  }
  CHECK(fs::exists(capture.out + "/masks/v0.png"));
}

TEST_CASE("ngs cut of a capture and ngs-gs.sh, with the same options, write the same labelled.ply and object.ply") {
  const ChainCapture capture;
  const std::vector<std::string> same{"--quality", "draft", "--hold-out", "every:4:2", "--gt", "my scene/masks"};
  test::succeeded(capture.ngs_gs(test::joined({"my scene", "the output"}, same)));
  test::succeeded(test::run_tool(test::joined({"ngs", "cut", "my scene", "-o", "cut"}, same), capture.dir.path()));
  for (const char* name : {"labelled.ply", "object.ply", "background.ply", "masks/v2.png", "metrics.json"}) {
    CAPTURE(name);
    CHECK(test::read_bytes(capture.out + "/" + name) == test::read_bytes(capture.dir.path() + "/cut/" + name));
  }
}

/// The tool commands among the lines, as sets of words. Left out: words that all tools take, the folders of results
/// (the script keeps intermediate masks in .state/), and options that `ngs cut` gives with the value of their default.
std::vector<std::multiset<std::string>> plan_of(const std::string& text) {
  std::vector<std::multiset<std::string>> plan;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::multiset<std::string> command;
    std::string tool, word, report;
    if (!(words >> tool) || !tool.starts_with("ngs-")) continue;
    while (words >> word) {
      if (word == "--report") words >> report;
      if (word == "-j" || word == "--seed" || word == "--report" || word == "--image-scale" || word == "--fill")
        words >> word;
      else if (word != "-w" && word != "--allow-empty")
        command.insert(word.find('/') == word.npos ? word : fs::path(word).filename().string());
    }
    command.insert(tool);
    if (!report.ends_with("/ngs-eval-input.json"))
      plan.push_back(command);  // the scores of the input masks: script only
  }
  return plan;
}

TEST_CASE("ngs-gs.sh -n prints the steps that ngs cut -n plans for a capture, with the same words") {
  const ChainCapture capture("scene");  // no quotes in the plans
  const test::Words same{"--quality", "draft", "--hold-out", "every:4:2", "-n"};
  const test::ProcessResult by_script = capture.ngs_gs(test::joined({"scene", "out"}, same));
  const test::ProcessResult by_cut =
      test::run_tool(test::joined({"ngs", "cut", "scene", "-o", "out"}, same), capture.dir.path());
  INFO(by_script.out << by_script.err << by_cut.out << by_cut.err);
  auto planned = plan_of(by_cut.err);
  REQUIRE(planned.size() == 8);
  REQUIRE(planned[0].count("capture.json") == 1);  // ngs cut keeps the scene.json of its import apart from the cut one
  planned[0].extract("capture.json");
  planned[0].insert("scene.json");
  CHECK(plan_of(by_script.out) == planned);
  CHECK_FALSE(capture.has("out"));
}

TEST_CASE("ngs-gs.sh renders masks at the photos' size if the working size does not divide it") {
  const ChainCapture capture;
  test::succeeded(capture.run({"--image-scale", "0.3", "--method", "flash"}));
  CHECK(io::read_image_size(capture.out + "/masks/v2.png") == io::ImageSize{48, 36});  // 14 / 0.3 is 47
}

TEST_CASE("ngs-gs.sh passes --device only to tools with a CUDA path") {
  const ChainCapture capture;
  const auto given = [&](std::vector<std::string> further) {  // tool -> true if its command has the option
    further.insert(further.end(), {"-n", "--artifacts", "all", "--device", "cuda"});
    const test::ProcessResult result = test::succeeded(capture.run(further));
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

TEST_CASE("ngs-gs.sh returns the exit code of the failed tool, and prints its message once") {
  const ChainCapture capture;
  fs::resize_file(capture.path("my scene/model.ply"), 300);
  const test::ProcessResult failed = test::refused(capture.run({}), 3, "model.ply");
  CHECK(test::occurrences(failed.err, "error: ") == 1);
}

TEST_CASE("ngs-gs.sh rejects invalid arguments") {
  const ChainCapture capture;
  fs::create_directory(capture.path("empty"));
  CHECK(capture.ngs_gs({}).exit_code == 2);
  CHECK(capture.ngs_gs({"nowhere", "out"}).exit_code == 3);
  CHECK(capture.ngs_gs({"empty", "out", "--image-scale", "none"}).exit_code == 2);
  test::refused(capture.ngs_gs({"empty", "out"}), 3, "no cameras found");
}

TEST_CASE("ngs-gs.sh computes the field only if a stage reads it or with --artifacts all") {
  const ChainCapture capture;
  const auto has_field = [&] {
    return fs::exists(capture.out + "/queries.ply") && fs::exists(capture.out + "/field.ply");
  };
  REQUIRE(capture.run({"--method", "flash"}).exit_code == 0);
  CHECK_FALSE(has_field());
  const auto bytes = [&] { return test::read_bytes(capture.out + "/labelled.ply"); };
  const std::string labelled = bytes();
  SUBCASE("requested") {
    CHECK(capture.run({"--method", "flash", "--artifacts", "all"}).exit_code == 0);
    CHECK(has_field());
    CHECK(bytes() == labelled);
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

TEST_CASE("ngs-gs.sh scores against input masks as ngs-scene reads them, or not at all") {
  const ChainCapture capture;
  const std::string masks = capture.path("my scene") + "/masks/";
  const auto run = [&](const char* scene_flags, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"my scene", "the output", "--hold-out", "every:4:2", "--method", "flash"});
    return capture.ngs_gs(more, {{"SCENE_FLAGS", scene_flags}});
  };
  const auto iou = [&] { return capture.json("the output/metrics.json")["mean"]["iou"].get<double>(); };
  SUBCASE("label maps") {
    test::succeeded(run("--mask-mode label", {"--masks", "my scene/labels"}));
    CHECK(iou() > 0.8);
  }
  SUBCASE("label maps with void pixels") {
    for (const fs::directory_entry& file : fs::directory_iterator(capture.path("my scene") + "/labels")) {
      const io::RawMask labels = io::read_mask_raw(file.path().string(), io::Palette::kIndices);
      ImageU8 with_void(labels.width_px, labels.height_px, 1);
      for (std::size_t p = 0; p < with_void.data.size(); ++p)
        with_void.data[p] = p < 3 * std::size_t(labels.width_px) ? 255 : std::uint8_t(labels.data[p]);
      io::write_png(file.path().string(), with_void);
    }
    test::succeeded(run("--mask-mode label --void-id 255", {"--masks", "my scene/labels"}));
    const nlohmann::json metrics = capture.json("the output/metrics.json");
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
    const test::ProcessResult result = test::succeeded(run("--mask-invert"));
    CHECK(result.err.find("nothing is scored: no true masks are known, and the input masks are inverted") !=
          std::string::npos);
    CHECK_FALSE(fs::exists(capture.out + "/metrics.json"));
    CHECK(fs::exists(capture.out + "/report.html"));
  }
  SUBCASE("no held-out view has a mask") {
    fs::remove(masks + "v2.png");
    fs::remove(masks + "v6.png");
    const test::ProcessResult result = test::succeeded(run(""));
    CHECK(result.err.find("nothing is scored: no true masks are known, and no held-out view has an input mask") !=
          std::string::npos);
    CHECK(fs::exists(capture.out + "/report.html"));
    const auto before = times_of(capture.out);
    CHECK(run("").exit_code == 0);
    CHECK(times_of(capture.out) == before);
  }
}

TEST_CASE("ngs-gs.sh rejects an output folder where it would replace masks that it did not render") {
  const ChainCapture capture;
  const std::string scene = capture.path("my scene"), out = capture.out;
  const auto refused = [&](std::vector<std::string> arguments, const std::string& because) {
    CAPTURE(arguments);
    const auto before = times_of(capture.dir.path());
    const test::ProcessResult result = test::refused(capture.ngs_gs(arguments), 2, because);
    CHECK(result.err.find("hint: ") != std::string::npos);
    CHECK(times_of(capture.dir.path()) == before);
  };
  SUBCASE("the scene, by any name") {
    refused({"my scene", "my scene", "--hold-out", "every:4:2"}, "is the input");
    fs::create_directory_symlink("my scene", capture.dir.path() + "/link");
    refused({"my scene", "link", "-n"}, "is the input");
    refused({"my scene", "my scene/masks"}, "is the input");
  }
  SUBCASE("masks or truth in OUT_DIR/masks, or below it") {
    fs::create_directories(out + "/masks");
    fs::copy(scene + "/masks", out + "/masks/cup");
    refused({"my scene", "the output", "--masks", "the output/masks"}, "is the input the output/masks");
    refused({"my scene", "the output", "--gt", "the output/masks/cup"}, "contains the input");
  }
  SUBCASE("a model that the result would replace") {
    REQUIRE(capture.run({"--method", "flash"}).exit_code == 0);
    refused({"my scene", "the output", "--model", "the output/background.ply"},
            "is the input the output/background.ply");
  }
  SUBCASE("masks added next to the rendered ones") {
    REQUIRE(capture.run({"--method", "flash"}).exit_code == 0);
    fs::copy(scene + "/masks/v0.png", out + "/masks/mine.png");
    refused({"my scene", "the output", "--method", "sa3d"},
            "the output/masks/mine.png: no run of this chain has written it");
  }
  SUBCASE("masks without a record, until they are moved away") {
    fs::create_directories(out);
    fs::copy(scene + "/masks", out + "/masks");
    refused({"my scene", "the output"}, "the output/masks: no run of this chain has written it");
    fs::rename(out + "/masks", out + "/mine");
    CHECK(capture.ngs_gs({"my scene", "the output", "--until", "scene.json"}).exit_code == 0);
  }
}

}  // namespace
}  // namespace ngs
