#include "support/hinted_flags.h"

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "support/tool_fixture.h"

namespace ngs::test {
namespace {

using Words = std::vector<std::string>;

Words words_of(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// The ngs command that begins at words[at]; empty: none.
Words command_at(const Words& words, std::size_t at) {
  static const std::regex tool("ngs(-[a-z]+)?");
  static const std::set<std::string> of_several{"ngs", "ngs-scene", "ngs-variance"};
  static const std::regex command("cut|import|orbit|check|undistort|degrade|merge");
  const auto bare = [](std::string word) {
    while (!word.empty() && std::string(":,;.()'").find(word.back()) != std::string::npos) word.pop_back();
    return word.substr(std::min(word.find_first_not_of("('"), word.size()));
  };
  const std::string first = bare(words[at]);
  if (!std::regex_match(first, tool)) return {};
  const std::string second = at + 1 < words.size() ? bare(words[at + 1]) : "";
  if (of_several.contains(first) && std::regex_match(second, command)) return {first, second};
  return {first};
}

bool ends_sentence(const std::string& word) {
  return std::string(";.").find(word.back()) != std::string::npos && !word.ends_with("..");
}

void add_flags(const Words& said_by, const std::string& text, std::vector<HintedFlag>& found) {
  static const std::set<std::string> foreign{"colmap",  "mogrify",      "magick",
                                             "convert", "heif-convert", "splat-transform"};
  static const std::regex flag("[^a-zA-Z-]*(--[a-z][a-z0-9-]*).*");
  const Words words = words_of(text);
  std::vector<Words> commands{said_by};
  std::vector<std::string> flags;
  bool is_foreign = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (const Words named = command_at(words, i); !named.empty()) commands.push_back(named), is_foreign = false;
    if (words[i].starts_with("import")) commands.push_back({"ngs-scene", "import"});
    if (foreign.contains(words[i])) is_foreign = true;
    std::smatch match;
    if (!is_foreign && std::regex_match(words[i], match, flag)) flags.push_back(match[1].str());
    if (!ends_sentence(words[i]) && i + 1 < words.size()) continue;
    for (const std::string& name : flags) found.push_back({commands, name});
    commands = {said_by}, flags.clear(), is_foreign = false;
  }
}

const std::string& help_of(const Words& command) {
  static std::map<Words, std::string> texts;
  std::string& text = texts[command];
  if (text.empty()) {
    nlohmann::json run = command;
    run.push_back("--help"), run.push_back("all");
    text = run_process(test::command(run)).out;
  }
  return text;
}

}  // namespace

std::vector<HintedFlag> hinted_flags(const std::string& err) {
  static const std::regex line_of("(ngs(?:-[a-z]+)?(?: [a-z]+)?): (?:hint|warning): (.*)");
  std::vector<HintedFlag> found;
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, line_of)) add_flags(words_of(match[1].str()), match[2].str(), found);
  }
  return found;
}

bool has_flag(const HintedFlag& hinted) {
  const std::string name = hinted.flag.substr(2);
  const std::string positive = name.starts_with("no-") ? name.substr(3) : name;
  const std::regex listed("(^|[\\s,])--(" + name + "|\\[no-\\]" + positive + ")($|[\\s,=\\]])");
  return std::ranges::any_of(hinted.commands,
                             [&](const Words& command) { return std::regex_search(help_of(command), listed); });
}

}  // namespace ngs::test
