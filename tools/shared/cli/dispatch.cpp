#include "shared/cli/dispatch.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/options/near_matches.h"
#include "shared/cli/command_line.h"
#include "shared/cli/exit_code.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

using Words = std::vector<std::string>;

const Command* find(const std::vector<Command>& commands, const std::string& name) {
  const auto found = std::ranges::find(commands, name, &Command::name);
  return found == commands.end() ? nullptr : &*found;
}

std::string command_list(const std::string& tool, const std::vector<Command>& commands) {
  const int width = terminal_columns();
  std::string text = "usage: " + tool + " COMMAND ...\n\ncommands (each has --help):\n";
  for (const Command& command : commands) text += "  " + padded(command.name, 12) + command.summary + "\n";
  return rewrapped(text, width) + "\n" + wrapped("exit codes:", kExitCodeHelp, {2, width}) + "\n";
}

int print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  return kDone;
}

/// True for --version with or without --json and nothing else.
bool asks_for_version(const Words& words) {
  return std::ranges::find(words, "--version") != words.end() &&
         std::ranges::all_of(words, [](const std::string& word) { return word == "--version" || word == "--json"; });
}

int refuse(const std::string& tool, const std::string& word, const std::vector<Command>& commands) {
  Words names;
  for (const Command& command : commands) names.push_back(command.name);
  std::fprintf(stderr, "%s: error: %s\n%s: hint: %s\n", tool.c_str(),
               word.empty() ? "no command given" : ("unknown command '" + word + "'").c_str(), tool.c_str(),
               suggestion(word, names).c_str());
  return int(ErrorCode::kUsage);
}

}  // namespace

int dispatch(int argc, char** argv, const std::vector<Command>& commands) {
  const std::filesystem::path program = argv[0];
  const std::string tool = (program.extension() == ".exe" ? program.stem() : program.filename()).string();
  const Words words(argv + std::min(argc, 1), argv + argc);
  const std::string word = words.empty() ? "" : words.front();
  if (word == "--print-commands") {  // for scripts that list all tools; "" is the tool without a command
    std::string names;
    for (const Command& command : commands) names += command.name + "\n";
    return print(names);
  }
  if (const Command* command = find(commands, word); command != nullptr && !word.empty())
    return command->run(argc - 1, argv + 1);
  if (const Command* unnamed = find(commands, "")) return unnamed->run(argc, argv);
  if (word == "-h" || word == "--help") return print(command_list(tool, commands));
  if (asks_for_version(words)) return print(version_text(tool, std::ranges::find(words, "--json") != words.end()));
  return refuse(tool, word, commands);
}

}  // namespace ngs::cli
