#pragma once
// Contract cases that repeat one rule for each tool, output and input (contract/rules.json).
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace ngs::test {

/// The cases of `rules`: every call's list of one kind ("file", "reads", ...), item by item ("{it}"), with every rule
/// of that kind. What a call "reads" by name is also "found"; files in a folder are only "found". "more" is added to
/// the call's words, "put" replaces the item among them. Rules without "exit" are of inputs: exit 3, and the message
/// has the file's name.
nlohmann::json rule_cases(const nlohmann::json& rules);

/// The cases of every contract/cases/NAME.json by NAME, with its texts and the defaults of runs written out, and those
/// of the rules by "rules".
std::map<std::string, nlohmann::json> contract_cases();

}  // namespace ngs::test
