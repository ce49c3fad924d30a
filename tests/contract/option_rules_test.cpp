// The rules of every option, from the schemas that the tools print: a value that is no number, below or above the
// range, or none of the choices, gives exit 2 and a message that begins with the option. Options are checked before
// inputs, so the runs need none.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

test::ProcessResult result_of(const Words& argv, const Words& more) { return test::run_tool(test::joined(argv, more)); }

/// Every command line that has options of its own: {"ngs-rbf"}, {"ngs-scene", "import"}, {"ngs", "cut"}.
std::vector<Words> commands() {
  std::vector<Words> all = {{"ngs", "cut"}};
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(NGS_SOURCE_DIR) / "tools")) {
    const std::string tool = entry.path().filename().string();
    if (!tool.starts_with("ngs-")) continue;
    std::istringstream lines(result_of({tool}, {"--print-commands"}).out);
    for (std::string name; std::getline(lines, name);) all.push_back(name.empty() ? Words{tool} : Words{tool, name});
  }
  return all;
}

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
  for (const Words& command : commands()) {
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
