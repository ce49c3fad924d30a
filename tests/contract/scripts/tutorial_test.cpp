// Runs the ```sh blocks of docs/tutorial.md and of the tool pages unchanged, in one folder, with the tools and
// scripts of this tree in PATH. (```bash blocks need user data or other programs.)
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

const std::string kTutorial = NGS_SOURCE_DIR "/docs/tutorial.md";

struct Step {
  std::string commands;
  std::vector<std::string> made;  // files listed in the paragraph "Made: ..." after the block
};

void add_quoted(const std::string& line, std::vector<std::string>& names) {
  static const std::regex quoted("`([^`]+)`");
  for (std::sregex_iterator at(line.begin(), line.end(), quoted), end; at != end; ++at) names.push_back((*at)[1]);
}

std::vector<Step> steps_of(const std::string& page) {
  std::vector<Step> steps;
  enum class Part { kProse, kCommands, kMade } part = Part::kProse;
  std::istringstream lines(test::read_bytes(page));
  for (std::string line; std::getline(lines, line);) {
    if (part == Part::kCommands) {
      if (line == "```")
        part = Part::kProse;
      else
        steps.back().commands += line + "\n";
      continue;
    }
    if (line == "```sh") {
      part = Part::kCommands;
      steps.emplace_back();
    } else if (line.starts_with("Made: ")) {
      part = Part::kMade;
    } else if (line.empty()) {
      part = Part::kProse;
    }
    if (part == Part::kMade && !steps.empty()) add_quoted(line, steps.back().made);
  }
  return steps;
}

test::ProcessResult run_step(const std::string& folder, const std::string& commands) {
  const std::string path = NGS_TOOL_DIR ":" NGS_SOURCE_DIR "/pipelines:" + std::string(std::getenv("PATH"));
  return test::run_process({.argv = {"bash", "-euo", "pipefail", "-c", commands},
                            .environment = {{"PATH", path}, {"NGS_BIN", NGS_TOOL_DIR}, {"NGS_THREADS", "2"}},
                            .folder = folder});
}

/// The folder in which the tutorial was run, once for all tests.
const std::string& tour() {
  static const test::TempDir dir;
  static const bool worked = [] {
    for (const Step& step : steps_of(kTutorial)) {
      test::succeeded(run_step(dir.path(), step.commands));
      CHECK_FALSE(step.made.empty());
      for (const std::string& name : step.made) {
        INFO(name);
        REQUIRE(fs::is_regular_file(dir.path() + "/" + name));
        CHECK(fs::file_size(dir.path() + "/" + name) > 0);
      }
    }
    return true;
  }();
  CHECK(worked);
  return dir.path();
}

}  // namespace

TEST_CASE("every command of the tutorial runs and writes the files named in the text") {
  CHECK(steps_of(kTutorial).size() >= 10);
  CHECK(fs::exists(tour() + "/object.ply"));
}

TEST_CASE("the scores in the tutorial are those of its runs") {
  const std::string text = test::read_bytes(kTutorial);
  const std::regex row(R"(\| `(out/[a-z]+)` \| ([0-9.]+) \| ([0-9.]+) \| ([0-9.]+) \|)");
  int rows = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), row), end; at != end; ++at, ++rows) {
    const std::smatch& match = *at;
    CAPTURE(match.str());
    const std::string bytes = test::read_bytes(tour() + "/" + match[1].str() + "/metrics.json");
    const nlohmann::json mean = nlohmann::json::parse(bytes)["mean"];
    INFO(mean.dump());
    int column = 2;
    for (const char* score : {"iou", "biou", "biou_005"}) {
      // Three digits are printed; exp and log of another compiler may change the last one.
      CHECK(std::abs(mean[score].get<double>() - std::stod(match[std::size_t(column++)])) < 0.002);
    }
  }
  CHECK(rows == 3);
}

TEST_CASE("the examples on the tool pages run on the tutorial's files") {
  for (const test::SourceFile& page : test::source_files({"tools"}, {".md"})) {
    if (page.ends_with("/README.md")) continue;
    const std::vector<Step> steps = steps_of(NGS_SOURCE_DIR "/" + page.path);
    INFO(page.path);
    CHECK_FALSE(steps.empty());
    for (const Step& step : steps) {
      test::succeeded(run_step(tour(), step.commands));
    }
  }
}

}  // namespace ngs
