// Consistency of the documentation: tool pages contain the current help, and the page on formats lists every property
// and channel.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
const fs::path kTree = NGS_SOURCE_DIR;

test::ProcessResult tool_pages(std::vector<std::string> arguments) {
  test::ProcessSpec spec;
  spec.argv = {"bash", (kTree / "tests/ci/tool-pages.sh").string()};
  spec.argv.insert(spec.argv.end(), arguments.begin(), arguments.end());
  spec.environment = {{"NGS_BIN", NGS_TOOL_DIR}};
  return test::run_process(spec);
}

}  // namespace

TEST_CASE("tool pages contain the current help; otherwise run tests/ci/tool-pages.sh --write") {
  const test::ProcessResult result = tool_pages({"--check"});
  INFO(result.out << result.err);
  CHECK(result.exit_code == 0);
}

TEST_CASE("every tool has a page, and the overview of the tools links to it") {
  const std::string overview = test::read_bytes((kTree / "tools/README.md").string());
  for (const fs::directory_entry& entry : fs::directory_iterator(kTree / "tools")) {
    const std::string name = entry.path().filename().string();
    if (name != "ngs" && !name.starts_with("ngs-")) continue;
    const std::string page = name + "/" + name + ".md";
    CAPTURE(page);
    CHECK(fs::exists(kTree / "tools" / page));
    CHECK(overview.find("(" + page + ")") != std::string::npos);
  }
}

TEST_CASE("ngs lists every tool") {
  test::ProcessSpec spec;
  spec.argv = {NGS_TOOL_DIR "/ngs"};
  const test::ProcessResult list = test::run_process(spec);
  CHECK(list.exit_code == 0);
  for (const fs::directory_entry& entry : fs::directory_iterator(kTree / "tools")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("ngs-")) continue;
    CAPTURE(name);
    CHECK(list.out.find("\n  " + name.substr(4) + " ") != std::string::npos);
  }
}

TEST_CASE("docs/formats.md lists every PLY property and EXR channel") {
  const std::string page = test::read_bytes((kTree / "docs/formats.md").string());
  for (const char* list : {"ply-properties.json", "exr-channels.json"}) {
    const nlohmann::json entries = nlohmann::json::parse(test::read_bytes((kTree / "data-schema" / list).string()));
    for (const nlohmann::json& entry : entries) {
      const std::string name = entry["name"];
      CAPTURE(name);
      CHECK(page.find("`" + name + "`") != std::string::npos);
    }
  }
}

}  // namespace ngs
