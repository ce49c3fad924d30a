// Consistency of the documentation: tool pages contain the current help, the README is short, and the page on formats
// lists every property and channel.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::SourceFile;

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

TEST_CASE("tool-pages.sh detects an outdated page and updates it") {
  const test::TempDir dir;
  for (const SourceFile& page : test::source_files({"tools"}, {".md"})) dir.write(page.path, page.text);
  const std::string folder = dir.path() + "/tools", page = folder + "/ngs-rbf/ngs-rbf.md";
  REQUIRE(tool_pages({"--write", folder}).exit_code == 0);
  const std::string right = test::read_bytes(page);
  std::string wrong = right;
  const std::size_t at = wrong.find("--neighbours");
  REQUIRE(at != wrong.npos);
  dir.write("tools/ngs-rbf/ngs-rbf.md", wrong.replace(at, 12, "--neighbors"));
  const test::ProcessResult check = tool_pages({"--check", folder});
  CHECK(check.exit_code == 1);
  CHECK(check.out.find("--neighbors") != std::string::npos);
  CHECK(tool_pages({"--write", folder}).exit_code == 0);
  CHECK(test::read_bytes(page) == right);
}

TEST_CASE("every tool has a page, and the README links to it") {
  const std::string readme = test::read_bytes((kTree / "README.md").string());
  int tools = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kTree / "tools")) {
    const std::string name = entry.path().filename().string();
    if (name != "ngs" && !name.starts_with("ngs-")) continue;
    const std::string page = "tools/" + name + "/" + name + ".md";
    CAPTURE(page);
    CHECK(fs::exists(kTree / page));
    CHECK(readme.find("(" + page + ")") != std::string::npos);
    ++tools;
  }
  CHECK(tools == 15);
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

TEST_CASE("the README has at most 100 lines of at most 140 characters") {
  std::istringstream lines(test::read_bytes((kTree / "README.md").string()));
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    CAPTURE(line);
    CHECK(std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xc0) != 0x80; }) <= 140);
  }
  CHECK(count > 0);
  CHECK(count <= 100);
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
