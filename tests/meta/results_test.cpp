// All measurements in tables of README.md and BENCHMARKS.md come from tests/bench/results/.
#include <doctest/doctest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

#include "results_table/markers.h"
#include "results_table/result.h"
#include "support/process.h"
#include "support/schema_check.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

const fs::path kTop = NGS_SOURCE_DIR;
const fs::path kResults = kTop / "tests/bench/results";

std::string page(const char* name) { return test::read_bytes((kTop / name).string()); }

test::ProcessResult results_script(const char* option) {
  test::ProcessSpec spec;
  spec.argv = {"bash", (kTop / "tests/bench/results.sh").string(), option};
  spec.environment = {{"NGS_BIN", NGS_TOOL_DIR}};
  return test::run_process(spec);
}

/// The first words of `results.sh --list`.
std::vector<std::string> questions() {
  const test::ProcessResult listed = results_script("--list");
  INFO(listed.err);
  REQUIRE(listed.exit_code == 0);
  std::vector<std::string> names;
  std::istringstream lines(listed.out);
  for (std::string line; std::getline(lines, line);) names.push_back(line.substr(0, line.find(' ')));
  return names;
}

std::vector<results::Result> all_results() {
  std::vector<results::Result> all;
  for (const test::SourceFile& file : test::source_files({"tests/bench/results"}, {".json"}))
    all.push_back(results::read_result((kTop / file.path).string()));
  return all;
}

/// Table rows in `markdown` with a measurement: a number with at least two decimals, or with a unit.
std::vector<std::string> figure_rows(const std::string& markdown) {
  static const std::regex figure(
      "(^|[ |(~])[+-]?[0-9]*\\.[0-9][0-9]+([ |,;)x]|$)|[0-9] (CPU )?(s|ms|min|MiB|GiB|dB)\\b");
  std::vector<std::string> rows;
  std::istringstream lines(markdown);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty() && line[0] == '|' && std::regex_search(line, figure)) rows.push_back(line);
  return rows;
}

}  // namespace

TEST_CASE("every result satisfies its schema and has the name of its question") {
  const results::Json schema = results::Json::parse(page("data-schema/result.schema.json"));
  int found = 0;
  for (const test::SourceFile& file : test::source_files({"tests/bench/results"}, {".json"})) {
    INFO(file.path);
    nlohmann::json result = nlohmann::json::parse(file.text);
    CHECK(test::schema_violations(schema, result) == "");
    CHECK(fs::path(file.path).stem() == result.value("question", ""));
    result["columns"][0]["show"] = "guess";
    CHECK(test::schema_violations(schema, result) != "");
    ++found;
  }
  CHECK(found > 0);
}

TEST_CASE("every question has a result and a table in BENCHMARKS.md, and there are no other results") {
  const std::vector<std::string> expected = questions();
  const std::vector<std::string> shown = results::blocks_of(page("BENCHMARKS.md"));
  CHECK(std::set<std::string>(shown.begin(), shown.end()) == std::set<std::string>(expected.begin(), expected.end()));
  CHECK(shown.size() == expected.size());
  std::set<std::string> measured;
  for (const results::Result& result : all_results()) measured.insert(result.question);
  CHECK(measured == std::set<std::string>(expected.begin(), expected.end()));
}

TEST_CASE("all results are of one commit and one machine") {
  const std::vector<results::Result> all = all_results();
  REQUIRE_FALSE(all.empty());
  for (const results::Result& result : all) {
    INFO(result.question);
    CHECK(result.commit == all.front().commit);
    CHECK(result.machine == all.front().machine);
  }
}

TEST_CASE("tables of pages and help match the results; otherwise run tests/bench/results.sh --write") {
  const test::ProcessResult check = results_script("--check");
  INFO(check.out << check.err);
  CHECK(check.exit_code == 0);
}

TEST_CASE("hand-written tables contain no measurements") {
  for (const char* name : {"README.md", "BENCHMARKS.md"}) {
    INFO(name);
    CHECK(test::listed(figure_rows(results::without_blocks(page(name)))) == "");
  }
  for (const char* row : {"| flash | 0.9636 |", "| bce | 1.5 s |", "| x | +.0019 |", "| y | 2.04x |"}) {
    INFO(row);
    CHECK(figure_rows(row).size() == 1);
  }
  CHECK(figure_rows("| `--tau 0.6` | §5.8, 2 options |\n0.9636\n").empty());
}

}  // namespace ngs
