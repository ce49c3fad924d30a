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
  return test::run_process({.argv = test::joined({"bash", (kTree / "tests/ci/tool-pages.sh").string()}, arguments),
                            .environment = {{"NGS_BIN", NGS_TOOL_DIR}}});
}

}  // namespace

TEST_CASE("tool pages contain the current help; otherwise run tests/ci/tool-pages.sh --write") {
  test::succeeded(tool_pages({"--check"}));
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
  const test::ProcessResult list = test::succeeded(test::run_tool({"ngs"}));
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
