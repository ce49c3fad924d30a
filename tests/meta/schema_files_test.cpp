#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "support/process.h"
#include "support/schema_check.h"
#include "support/source_tree.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const fs::path kSchemas = fs::path(NGS_SOURCE_DIR) / "data-schema";

std::string output_of(const Words& argv) { return test::succeeded(test::run_tool(argv)).out; }

nlohmann::json printed(const Words& command, const Words& flags) {
  return nlohmann::json::parse(output_of(test::joined(command, flags)));
}

}  // namespace

TEST_CASE("the defaults of every tool satisfy the schema that it prints, and an unknown option does not") {
  const std::vector<Words> all = test::tool_commands();
  REQUIRE(all.size() >= test::tool_names().size());
  for (const Words& command : all) {
    INFO(command.front() << " " << command.back());
    const nlohmann::json schema = printed(command, {"--print-schema"});
    nlohmann::json options = printed(command, {"--print-options"});
    CHECK(test::schema_violations(schema, options) == "");
    options["no_such_option"] = 1;
    CHECK(test::schema_violations(schema, options) != "");

    std::string file = command.front();
    if (command.size() > 1) file += "-" + command.back();
    const nlohmann::json report = printed(command, {"--print-schema", "report"});
    const nlohmann::json::json_pointer reference("/properties/options/allOf/0/$ref");
    CHECK(report.at(reference) == "../options/" + file + ".schema.json");
  }
}

TEST_CASE("every .json file of data-schema/ is valid JSON") {
  for (const test::SourceFile& file : test::source_files({"data-schema"}, {".json"})) {
    INFO(file.path);
    CHECK_FALSE(nlohmann::json::parse(file.text, nullptr, false).is_discarded());
  }
}

TEST_CASE("data-schema/README.md lists every schema, and only existing ones") {
  const std::string table = test::read_bytes((kSchemas / "README.md").string());
  const std::regex name("`([a-z-]+\\.(schema\\.)?json)`");
  std::set<std::string> named;
  for (std::sregex_iterator at(table.begin(), table.end(), name), end; at != end; ++at) named.insert((*at)[1]);
  for (const fs::directory_entry& entry : fs::directory_iterator(kSchemas))
    if (entry.path().extension() == ".json") {
      INFO(entry.path().string());
      CHECK(named.count(entry.path().filename().string()) == 1);
    }
  for (const std::string& file : named)
    if (file.find(".schema.") != std::string::npos) {
      INFO(file);
      CHECK(fs::exists(kSchemas / file));
    }
}

}  // namespace ngs
