#include "support/hinted_flags.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "support/tool_fixture.h"

namespace ngs::test {
namespace {

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
  const Words words = split(text);
  std::vector<Words> commands{said_by};
  std::vector<std::string> flags;
  bool is_foreign = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (const Words named = command_at(words, i); !named.empty()) {
      commands.push_back(named);
      is_foreign = false;
    }
    if (words[i].starts_with("import")) commands.push_back({"ngs-scene", "import"});
    if (foreign.contains(words[i])) is_foreign = true;
    std::smatch match;
    if (!is_foreign && std::regex_match(words[i], match, flag)) flags.push_back(match[1].str());
    if (!ends_sentence(words[i]) && i + 1 < words.size()) continue;
    for (const std::string& name : flags) found.push_back({commands, name});
    commands = {said_by};
    flags.clear();
    is_foreign = false;
  }
}

/// Words as a shell would split them; quotes are removed. `ends`: whether punctuation follows a word, which is removed.
struct ShellWords {
  Words words;
  std::vector<bool> ends;
};

ShellWords shell_words_of(const std::string& text) {
  ShellWords out;
  std::string word;
  bool any = false, quoted = false, in_quotes = false;  // in_quotes: the word began with a quote
  const auto close = [&] {
    if (!any) return;
    const std::size_t last = word.find_last_not_of(",;:.)");
    const bool ends = !word.ends_with("..") && last != word.npos && last + 1 < word.size();
    out.words.push_back(ends ? word.substr(0, last + 1) : word);
    out.ends.push_back(ends);
    word.clear();
    any = false;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (!any) in_quotes = c == '\'';
    const bool opens = c == '\'' && in_quotes;
    if (c == '\\' && !quoted && i + 1 < text.size()) {
      word += text[++i];
      any = true;
    } else if (opens) {
      quoted = !quoted;
      any = true;
    } else if (!quoted && (c == ' ' || c == '('))
      close();
    else {
      word += c;
      any = true;
    }
  }
  return close(), out;
}

bool is_placeholder(const std::string& word) {
  static const std::regex capitals("[A-Z][A-Z0-9_]*([,=.:-][A-Za-z0-9]*)*(=.*)?|.*=[A-Z]+|.*\\.\\.\\..*");
  return word.find('/') == word.npos && std::regex_match(word, capitals);
}

bool is_file(const std::string& word) {
  static const std::regex file(".*/.*|.*[^.]\\.[A-Za-z][A-Za-z0-9]*");
  return std::regex_match(word, file);
}

/// Flags without a value, as far as hints name them.
bool is_switch(const std::string& flag) {
  static const Words switches = split(
      "--activated --all-pieces --allow-empty --mask-invert --no-check-polarity --no-align-views --resume --force "
      "--fast-atomics --original-world -w --dry-run");
  return std::find(switches.begin(), switches.end(), flag) != switches.end() || flag.starts_with("--no-") ||
         flag.find('=') != flag.npos;
}

/// The command at words[at] up to the first word of prose; empty: not complete.
Words complete_command_at(const ShellWords& text, std::size_t at) {
  Words command = command_at(text.words, at);
  if (command.empty() || text.words[at] != command[0]) return {};
  bool has_file = false, is_value = false;
  for (std::size_t i = at + command.size(), ended = at + command.size() - 1; i < text.words.size(); ++i) {
    if (text.ends[ended]) break;
    const std::string& word = text.words[i];
    const bool is_flag = !is_value && word.starts_with("-") && word.size() > 1;
    if (!is_flag && is_placeholder(word)) return {};
    if (!is_flag && !is_value && !is_file(word)) break;
    has_file |= !is_flag && is_file(word);
    is_value = is_flag && !is_switch(word);
    command.push_back(word);
    ended = i;
  }
  return has_file && !is_value ? command : Words{};
}

const std::string& help_of(const Words& command) {
  static std::map<Words, std::string> texts;
  std::string& text = texts[command];
  if (text.empty()) {
    nlohmann::json run = command;
    run.push_back("--help");
    run.push_back("all");
    text = run_process(test::command(run)).out;
  }
  return text;
}

/// Calls use(tool, text) for each hint and warning.
template <class Use>
void for_each_hint(const std::string& err, const Use& use) {
  static const std::regex line_of("(ngs(?:-[a-z]+)?(?: [a-z]+)?): (?:hint|warning): (.*)");
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, line_of)) use(match[1].str(), match[2].str());
  }
}

}  // namespace

std::vector<HintedFlag> hinted_flags(const std::string& err) {
  std::vector<HintedFlag> found;
  for_each_hint(err, [&](const std::string& tool, const std::string& text) { add_flags(split(tool), text, found); });
  return found;
}

std::vector<Words> hinted_commands(const std::string& err) {
  std::vector<Words> found;
  for_each_hint(err, [&](const std::string&, const std::string& text) {
    const ShellWords words = shell_words_of(text);
    for (std::size_t i = 0; i < words.words.size(); ++i)
      if (Words command = complete_command_at(words, i); !command.empty()) found.push_back(std::move(command));
  });
  return found;
}

bool has_its_inputs(const Words& command, const std::string& folder) {
  static const std::set<std::string> outputs{"-o",         "--output",    "--object-ply", "--background-ply",
                                             "--labelled", "--report",    "--sheet",      "--npz",
                                             "--partial",  "--checkpoint"};
  for (std::size_t i = 1; i < command.size(); ++i)
    if (is_file(command[i]) && !outputs.contains(command[i - 1]) &&
        !std::filesystem::exists(std::filesystem::path(folder) / command[i]))
      return false;
  return true;
}

bool has_flag(const HintedFlag& hinted) {
  const std::string name = hinted.flag.substr(2);
  const std::string positive = name.starts_with("no-") ? name.substr(3) : name;
  const std::regex listed("(^|[\\s,])--(" + name + "|\\[no-\\]" + positive + ")($|[\\s,=\\]])");
  return std::ranges::any_of(hinted.commands,
                             [&](const Words& command) { return std::regex_search(help_of(command), listed); });
}

}  // namespace ngs::test
