#include "support/rule_cases.h"

#include <filesystem>
#include <string>

#include "support/tool_fixture.h"

namespace ngs::test {
namespace {

using Json = nlohmann::json;

Json made(const Json& rule, const Json& call, const std::string& item) {
  Json spec = with_text(rule, "{it}", item);
  Json run = call["run"];
  for (Json& word : run)
    if (word == item && rule.contains("put")) word = rule["put"];
  for (const Json& word : rule.value("more", Json::array())) run.push_back(word);
  const std::string file = std::filesystem::path(item).filename().string();
  spec["run"] = run;
  const std::string tool = call["run"][0], command = call["run"][1];
  spec["name"] = tool + (command.starts_with("{") ? "" : " " + command) + " " + rule["name"].get<std::string>() +
                 (rule.contains("exit") ? "" : ": " + file);
  if (rule.contains("exit")) return spec;
  spec["exit"] = 3;
  spec["stderr_contains"].push_back(file);
  return spec;
}

}  // namespace

Json rule_cases(const Json& rules) {
  Json cases = Json::array();
  for (Json call : rules["calls"]) {
    call["every"] = {""};
    for (const Json& item : call.value("reads", Json::array())) call["found"].push_back(item);
    for (const auto& [kind, items] : call.items())
      for (const Json& rule : kind == "run" ? Json::array() : rules.at(kind))
        for (const Json& item : items) cases.push_back(made(rule, call, item));
  }
  return cases;
}

}  // namespace ngs::test
