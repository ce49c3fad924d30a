#include <doctest/doctest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const fs::path kSchemas = fs::path(NGS_SOURCE_DIR) / "data-schema";

Words tools() {
  Words names;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(NGS_SOURCE_DIR) / "tools"))
    if (const std::string name = entry.path().filename().string(); name == "ngs" || name.starts_with("ngs-"))
      names.push_back(name);
  return names;
}

std::string output_of(Words argv) {
  argv[0] = NGS_TOOL_DIR "/" + argv[0];
  test::ProcessSpec spec;
  spec.argv = std::move(argv);
  const test::ProcessResult result = test::run_process(spec);
  INFO(spec.argv[0] << ": " << result.err);
  CHECK(result.exit_code == 0);
  return result.out;
}

/// Name of the schema file -> command line of the tool or sub-command.
std::map<std::string, Words> commands() {
  std::map<std::string, Words> all;
  for (const std::string& tool : tools()) {
    std::istringstream lines(output_of({tool, "--print-commands"}));
    for (std::string command; std::getline(lines, command);) {
      if (command.empty())
        all[tool + ".schema.json"] = {tool};
      else
        all[tool + "-" + command + ".schema.json"] = {tool, command};
    }
  }
  return all;
}

}  // namespace

TEST_CASE("the committed schemas match the output of the tools; otherwise run data-schema/regenerate.sh") {
  const std::map<std::string, Words> all = commands();
  REQUIRE(all.size() >= tools().size());
  for (const auto& entry : all)
    for (const std::string& kind : {std::string("options"), std::string("report")}) {
      const auto& [file, command] = entry;
      INFO(kind << "/" << entry.first);
      Words argv = command;
      argv.insert(argv.end(), {"--print-schema", kind});
      const fs::path path = kSchemas / kind / file;
      REQUIRE(fs::exists(path));
      CHECK(test::read_bytes(path.string()) == output_of(argv));
    }
  for (const std::string& kind : {std::string("options"), std::string("report")})
    for (const fs::directory_entry& entry : fs::directory_iterator(kSchemas / kind)) {
      INFO(entry.path().string() << " belongs to no tool");
      CHECK(all.count(entry.path().filename().string()) == 1);
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
  int found = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kSchemas))
    if (entry.path().extension() == ".json") {
      INFO(entry.path().string());
      CHECK(named.count(entry.path().filename().string()) == 1);
      ++found;
    }
  CHECK(found > 10);
  for (const std::string& file : named)
    if (file.find(".schema.") != std::string::npos) {
      INFO(file);
      CHECK(fs::exists(kSchemas / file));
    }
}

TEST_CASE("all tools together have at most 200 different options, each tool at most 60") {
  constexpr std::size_t kMaxOptions = 200, kMaxOptionsOfTool = 60;
  std::set<std::string> all;
  for (const test::SourceFile& file : test::source_files({"data-schema/options"}, {".json"})) {
    const nlohmann::json options = nlohmann::json::parse(file.text).at("properties");
    const std::size_t count = options.size();
    INFO(file.path << ": " << count << " options, at most " << kMaxOptionsOfTool);
    CHECK(count <= kMaxOptionsOfTool);
    for (const auto& option : options.items())
      all.insert(option.key() + ": " + option.value().value("description", ""));
  }
  MESSAGE("options of all tools: ", all.size());
  CHECK(all.size() <= kMaxOptions);
}

TEST_CASE("a baseline has at most three options") {
  std::map<std::string, int> count;
  const nlohmann::json schema =
      nlohmann::json::parse(test::read_bytes((kSchemas / "options/ngs-joint.schema.json").string()));
  for (const auto& option : schema.at("properties").items())
    for (const nlohmann::json& method : schema.at("properties").at("method").at("enum"))
      if (const std::string prefix = method.get<std::string>() + "_"; option.key().starts_with(prefix)) ++count[prefix];
  CHECK(count.size() >= 5);
  for (const auto& baseline : count) {
    CAPTURE(baseline.first);
    CHECK(baseline.second <= 3);
  }
}

}  // namespace ngs
