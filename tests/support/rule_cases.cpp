#include "support/rule_cases.h"

#include <filesystem>
#include <fstream>

#include "support/tool_fixture.h"

namespace ngs::test {
namespace {

using Json = nlohmann::json;

/// "ngs-rbf" or "ngs-scene import": what a command line runs.
std::string program_of(const Json& run) {
  const std::string tool = run[0], command = run.size() > 1 ? run[1].get<std::string>() : "{}";
  return tool + (command.starts_with("{") || command.starts_with("-") ? "" : " " + command);
}

/// The words of a command, which are separated by spaces; words with spaces stand in single quotes.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  std::string word;
  bool is_quoted = false, has_quotes = false;
  for (const char c : command + " ") {
    if (c == '\'') {
      is_quoted = !is_quoted;
      has_quotes = true;
    } else if (c != ' ' || is_quoted) {
      word += c;
    } else if (has_quotes || !word.empty()) {
      words.push_back(word);
      word.clear();
      has_quotes = false;
    }
  }
  return words;
}

/// Makes "run" a list of words, and sets "exit" to 0 if it is absent.
void complete(Json& run) {
  if (run.is_string()) run = {{"run", run}};
  const Json given = run["run"].is_string() ? Json::array({run["run"]}) : run["run"];
  run["run"] = words_of(given[0].get<std::string>());
  for (std::size_t i = 1; i < given.size(); ++i) run["run"].push_back(given[i]);
  if (!run.contains("exit")) run["exit"] = 0;
}

/// The cases of a list; those of a group have what the group says, lists joined.
Json ungrouped(const Json& list) {
  Json cases = Json::array();
  for (const Json& entry : list) {
    if (!entry.contains("cases")) cases.push_back(entry);
    for (const Json& own : ungrouped(entry.value("cases", Json::array()))) {
      Json spec = entry;
      spec.erase("cases");
      for (const auto& [key, value] : own.items()) {
        const bool joins = spec.contains(key) && spec[key].is_array() && key != "run";
        if (joins)
          spec[key].insert(spec[key].end(), value.begin(), value.end());
        else
          spec[key] = value;
      }
      cases.push_back(spec);
    }
  }
  return cases;
}

/// The cases of a file, with its texts replaced ("{name}") and the defaults of runs written out.
Json expanded(const Json& file) {
  Json cases = ungrouped(file.is_array() ? file : file["cases"]);
  if (file.is_object())
    for (const auto& [name, text] : file.items())
      if (name != "cases") cases = with_text(cases, "{" + name + "}", text);
  for (Json& spec : cases) {
    complete(spec);
    if (spec.contains("before"))
      for (Json& step : spec["before"]) complete(step);
  }
  return cases;
}

Json made(const Json& rule, const Json& call, const std::string& item) {
  Json spec = with_text(rule, "{it}", item);
  Json run = call["run"];
  for (Json& word : run)
    if (word == item && rule.contains("put")) word = rule["put"];
  for (const Json& word : rule.value("more", Json::array())) run.push_back(word);
  const std::string file = std::filesystem::path(item).filename().string();
  spec["run"] = run;
  spec["name"] = program_of(run) + " " + rule["name"].get<std::string>() +
                 (rule.contains("exit") ? "" : ": " + item.substr(item.find('/') + 1));
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

std::map<std::string, Json> contract_cases() {
  const std::filesystem::path folder = NGS_SOURCE_DIR "/tests/contract";
  std::map<std::string, Json> cases = {{"rules", rule_cases(Json::parse(std::ifstream(folder / "rules.json")))}};
  for (const auto& entry : std::filesystem::directory_iterator(folder / "cases"))
    if (entry.path().extension() == ".json")
      cases[entry.path().stem().string()] = expanded(Json::parse(std::ifstream(entry.path())));
  return cases;
}

}  // namespace ngs::test
