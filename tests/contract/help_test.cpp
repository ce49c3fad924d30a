// The help of every tool and command, as a person sees it.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/text/text_columns.h"
#include "support/process.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

std::string said(Words argv, const std::string& columns = "100") {
  argv[0] = NGS_TOOL_DIR "/" + argv[0];
  test::ProcessSpec spec;
  spec.argv = std::move(argv);
  spec.environment = {{"COLUMNS", columns}};
  const test::ProcessResult result = test::run_process(spec);
  INFO(result.err);
  CHECK(result.exit_code == 0);
  return result.out;
}

std::string said(Words argv, const char* word, const std::string& columns = "100") {
  argv.emplace_back(word);
  return said(std::move(argv), columns);
}

Words lines_of(const std::string& text) {
  Words lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> tools() {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(NGS_SOURCE_DIR) / "tools"))
    if (const std::string name = entry.path().filename().string(); name.starts_with("ngs-")) names.push_back(name);
  std::ranges::sort(names);
  return names;
}

/// Every command line that has a help of its own: {"ngs-rbf"}, {"ngs-scene", "import"}.
std::vector<Words> commands() {
  std::vector<Words> all;
  for (const std::string& tool : tools())
    for (const std::string& command : lines_of(said({tool, "--print-commands"})))
      all.push_back(command.empty() ? Words{tool} : Words{tool, command});
  return all;
}

void check_width(const std::string& text, int columns) {
  for (const std::string& line : lines_of(text)) {
    CAPTURE(line);
    CHECK(cli::columns_of(line) <= columns);
  }
}

/// Without the breaks of lines, which may lie within a flag's value.
std::string unwrapped(std::string text) {
  std::erase_if(text, [](char c) { return c == '\n' || c == ' '; });
  return text;
}

}  // namespace

TEST_CASE("no help is wider than the terminal, and a short one has at most 30 lines of 100 columns") {
  const std::vector<Words> all = commands();
  REQUIRE(all.size() > 12);
  for (const Words& command : all) {
    INFO(command.front() << " " << command.back());
    for (const char* columns : {"60", "100"}) {
      check_width(said(command, "-h", columns), std::stoi(columns));
      check_width(said(command, "--help", columns), std::stoi(columns));
    }
    CHECK(lines_of(said(command, "-h")).size() <= 30);
  }
  for (const std::string& tool : tools()) check_width(said({tool, "--help"}, "60"), 60);
}

TEST_CASE("-h and --help begin with what the tool is and examples, and --help has more") {
  for (const Words& command : commands()) {
    const std::string brief = said(command, "-h"), full = said(command, "--help");
    std::string name = command.front();
    if (command.size() > 1) name += " " + command.back();
    CAPTURE(name);
    for (const std::string& text : {brief, full}) {
      CHECK(text.starts_with(name + ": "));
      CHECK(text.find("\n\nexamples:\n  " + command.front()) != text.npos);
      CHECK(text.find("\nusage: " + name) != text.npos);
    }
    CHECK(full.size() > brief.size());
    CHECK(full.find("\nexit codes: 0 done") != full.npos);
    CHECK(full.find("\nflags of all tools:\n") != full.npos);
  }
}

TEST_CASE("--help of ngs-joint has at most 80 lines, with another method its options and not those of the passes") {
  CHECK(lines_of(said({"ngs-joint", "--help"})).size() <= 80);
  const std::string cob = said({"ngs-joint", "--method", "cob", "--help"}), usual = said({"ngs-joint", "--help"});
  CHECK(cob.find("--cob-rounds") != cob.npos);
  CHECK(usual.find("--cob-rounds") == usual.npos);
  CHECK(usual.find("--contour-iterations") != usual.npos);
  CHECK(cob.find("--contour-iterations") == cob.npos);
  CHECK(usual.find("not shown: options of") != usual.npos);
}

TEST_CASE("--help -v explains every option of a tool whose groups all listen") {
  for (const Words& command : commands()) {
    Words verbose = command;
    verbose.emplace_back("-v");
    const std::string help = said(verbose, "--help");
    if (help.find("not shown: options of") != help.npos) continue;
    INFO(command.front() << " " << command.back());
    const std::string text = unwrapped(help);
    const nlohmann::json schema = nlohmann::json::parse(said(command, "--print-schema"));
    for (const auto& [name, property] : schema["properties"].items()) {
      std::string flag = name;
      std::ranges::replace(flag, '_', '-');
      CAPTURE(flag);
      CHECK(text.find((property["type"] == "boolean" ? "--[no-]" : "--") + flag) != text.npos);
    }
  }
}

TEST_CASE("every tool says its version as text and as JSON, in any order of the flags") {
  for (const std::string& tool : tools()) {
    CAPTURE(tool);
    CHECK(said({tool, "--version"}).starts_with(tool + " 0."));
    for (const Words& flags : {Words{"--version", "--json"}, Words{"--json", "--version"}}) {
      const nlohmann::json record = nlohmann::json::parse(said({tool, flags[0], flags[1]}), nullptr, false);
      REQUIRE_FALSE(record.is_discarded());
      CHECK(record["tool"] == tool);
      CHECK(record["version"].is_string());
    }
  }
}

TEST_CASE("a tool with commands refuses --json without --version, and a command it does not have") {
  test::ProcessSpec spec;
  for (const Words& words : {Words{"--json"}, Words{"imprt"}}) {
    spec.argv = {NGS_TOOL_DIR "/ngs-scene", words[0]};
    const test::ProcessResult result = test::run_process(spec);
    CHECK(result.exit_code == 2);
    CHECK(result.out == "");
    CHECK(result.err.find("unknown command '" + words[0] + "'") != result.err.npos);
  }
  CHECK(test::run_process(spec).err.find("did you mean 'import'?") != std::string::npos);
}

}  // namespace ngs
