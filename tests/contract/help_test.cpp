// The help of every tool and command.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/text/layout.h"
#include "support/process.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

using Words = std::vector<std::string>;

std::string output_of(Words argv, const std::string& columns = "100") {
  return test::succeeded(test::run_tool(argv, {}, {{"COLUMNS", columns}})).out;
}

std::string output_of(Words argv, const char* word, const std::string& columns = "100") {
  argv.emplace_back(word);
  return output_of(std::move(argv), columns);
}

Words lines_of(const std::string& text) {
  Words lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The tools and commands, without those of ngs, whose help is a list.
Words tools() {
  Words names = test::tool_names();
  std::erase(names, "ngs");
  return names;
}
std::vector<Words> commands() {
  std::vector<Words> all = test::tool_commands();
  std::erase_if(all, [](const Words& command) { return command.front() == "ngs"; });
  return all;
}

void check_width(const std::string& text, int columns) {
  for (const std::string& line : lines_of(text)) {
    CAPTURE(line);
    CHECK(cli::columns_of(line) <= columns);
  }
}

}  // namespace

TEST_CASE("no help is wider than the terminal; -h has at most 30 lines of 100 columns, --help 80") {
  const std::vector<Words> all = commands();
  REQUIRE(all.size() > 12);
  for (const Words& command : all) {
    INFO(command.front(), " ", command.back());
    for (const char* columns : {"60", "100"}) {
      check_width(output_of(command, "-h", columns), std::stoi(columns));
      check_width(output_of(command, "--help", columns), std::stoi(columns));
      check_width(output_of(command, "--help=all", columns), std::stoi(columns));
    }
    CHECK(lines_of(output_of(command, "-h")).size() <= 30);
    CHECK(lines_of(output_of(command, "--help")).size() <= 80);
  }
  for (const std::string& tool : tools()) check_width(output_of({tool}, "--help", "60"), 60);
}

TEST_CASE("-h and --help begin with the purpose of the tool and examples, and --help is longer") {
  for (const Words& command : commands()) {
    const std::string brief = output_of(command, "-h"), full = output_of(command, "--help");
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

TEST_CASE("--help of ngs-joint shows the options of the method, and ends with a list of the other groups") {
  const std::string usual = output_of({"ngs-joint", "--help"}),
                    cob = output_of({"ngs-joint", "--method", "cob", "--help"});
  for (const char* method : {"ng-gs", "bce", "cob", "flash", "sa3d", "saga", "released"})
    CHECK(lines_of(output_of({"ngs-joint", "--method", method, "--help"})).size() <= 80);
  CHECK(usual.find("--cob-rounds") == usual.npos);
  CHECK(cob.find("--cob-rounds") != cob.npos);
  CHECK(usual.find("--time-budget") != usual.npos);
  CHECK(cob.find("--time-budget") == cob.npos);
  const std::string last = lines_of(usual).back(), last_of_cob = lines_of(cob).back();
  CHECK(last.starts_with("more: --help joint|"));
  for (const char* group : {"contours", "sampling", "rbf", "field", "effects", "cob"})
    CHECK(last.find("|" + std::string(group) + "|") != last.npos);
  CHECK(last_of_cob.find("|cob|") == last_of_cob.npos);
}

TEST_CASE("the help shows the switches of the selected method") {
  const auto has_row = [](const std::string& help, const std::string& name, const std::string& mode) {
    return std::ranges::any_of(lines_of(help), [&](const std::string& line) {
      std::istringstream words(line);
      std::string first, second;
      return words >> first >> second && first == name && second == mode;
    });
  };
  const std::string ngs = output_of({"ngs-joint", "--help"}), all = output_of({"ngs-joint", "--help", "effects"});
  const std::string ng_gs = output_of({"ngs-joint", "--method", "ng-gs", "--help", "effects"});
  CHECK(has_row(ngs, "contours", "auto"));
  CHECK(has_row(ngs, "joint", "auto"));
  CHECK_FALSE(has_row(ngs, "nerf", "auto"));  // a part: shown with --help all only
  CHECK(has_row(all, "nerf", "auto"));
  CHECK(has_row(ng_gs, "nerf", "on"));
  CHECK(has_row(ng_gs, "contours", "off"));
  CHECK_FALSE(has_row(output_of({"ngs-joint", "--method", "cob", "--help", "effects"}), "joint", "auto"));
}

TEST_CASE("--help GROUP shows one group, whether it applies or not, and rejects an unknown group") {
  const std::string rbf = output_of({"ngs-joint", "--help", "rbf"});
  CHECK(rbf.starts_with("rbf: "));
  CHECK(rbf.find("\n  --neighbours N ") != rbf.npos);
  CHECK(rbf.find("\n\n") == rbf.npos);
  CHECK(output_of({"ngs-joint", "--help=cob"}).find("only with --method cob [default; range]:\n") != std::string::npos);
  CHECK(output_of({"ngs-joint", "--help", "quality"}).find("\n  standard ") != std::string::npos);
  const test::ProcessResult result = test::run_tool({"ngs-joint", "--help", "contour"});
  CHECK(result.exit_code == 2);
  CHECK(result.out == "");
  CHECK(result.err.find("no group 'contour', expected method, steps, joint, ") != std::string::npos);
  CHECK(result.err.find(", effects, all\n") != std::string::npos);
  CHECK(result.err.find("did you mean 'contours'?") != std::string::npos);
}

TEST_CASE("--help all has every option of every tool once, in the group that --help GROUP shows") {
  for (const Words& command : commands()) {
    INFO(command.front(), " ", command.back());
    const Words lines = lines_of(output_of(command, "--help=all"));
    const nlohmann::json schema = nlohmann::json::parse(output_of(command, "--print-schema"));
    for (const auto& [name, property] : schema["properties"].items()) {
      std::string flag = name;
      std::ranges::replace(flag, '_', '-');
      CAPTURE(flag);
      const std::string start = (property["type"] == "boolean" ? "  --[no-]" : "  --") + flag + " ";
      CHECK(std::ranges::count_if(lines, [&](const std::string& line) { return line.starts_with(start); }) == 1);
    }
  }
}

TEST_CASE("every tool prints its version as text and as JSON, in any order of the flags") {
  for (const std::string& tool : tools()) {
    CAPTURE(tool);
    CHECK(output_of({tool, "--version"}).starts_with(tool + " 0."));
    for (const Words& flags : {Words{"--version", "--json"}, Words{"--json", "--version"}}) {
      const nlohmann::json record = nlohmann::json::parse(output_of({tool, flags[0], flags[1]}), nullptr, false);
      REQUIRE_FALSE(record.is_discarded());
      CHECK(record["tool"] == tool);
      CHECK(record["version"].is_string());
    }
  }
}

TEST_CASE("a tool with commands rejects --json without --version, and an unknown command") {
  for (const std::string word : {"--json", "imprt"}) {
    const test::ProcessResult result = test::run_tool({"ngs-scene", word});
    CHECK(result.exit_code == 2);
    CHECK(result.out == "");
    CHECK(result.err.find("unknown command '" + word + "'") != result.err.npos);
    if (word == "imprt") CHECK(result.err.find("did you mean 'import'?") != std::string::npos);
  }
}

// The rules of every option, from the schemas that the tools print: a value that is no number, below or above the
// range, or none of the choices, gives exit 2 and a message that begins with the option. Options are checked before
// inputs, so the runs need none.

namespace {

using Json = nlohmann::json;

test::ProcessResult result_of(const Words& argv, const Words& more) { return test::run_tool(test::joined(argv, more)); }

/// Values that the option must reject.
Words invalid_values(const Json& option) {
  if (option.contains("enum")) return {"no-such-choice"};
  const bool whole = option["type"] == "integer";
  if (!whole && option["type"] != "number") return {};
  Words values = {"nan", "inf", "x"};
  if (whole) values.emplace_back("1.5");
  const double step = whole ? 1 : 1e-3, least = option["minimum"], most = option["maximum"];
  for (const double value : {least - step * (1 + std::abs(least)), most + step * (1 + std::abs(most))}) {
    std::ostringstream text;
    text << std::setprecision(17) << value;
    values.push_back(whole ? std::to_string(std::int64_t(value)) : text.str());
  }
  return values;
}

}  // namespace

TEST_CASE("every option rejects text, nan, infinity, values out of its range and unknown choices, and names itself") {
  int checked = 0;
  for (const Words& command : test::tool_commands()) {
    const Json schema = Json::parse(result_of(command, {"--print-schema", "options"}).out, nullptr, false);
    REQUIRE_FALSE(schema.is_discarded());
    for (const auto& [name, option] : schema["properties"].items())
      for (const std::string& value : invalid_values(option)) {
        std::string flag = "--" + name;
        std::ranges::replace(flag, '_', '-');
        const test::ProcessResult result = result_of(command, {flag + "=" + value});
        INFO(command.back(), " ", flag, "=", value, ": ", result.err);
        CHECK(result.exit_code == 2);
        CHECK(result.out == "");
        CHECK(result.err.find(": error: " + name + " = ") != result.err.npos);
        ++checked;
      }
  }
  CHECK(checked > 0);
}

}  // namespace ngs
