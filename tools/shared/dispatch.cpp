#include <cstdio>
#include <filesystem>

#include "ngs/core/version.h"
#include "ngs/options/near_matches.h"
#include "shared/tool.h"

namespace ngs::cli {
namespace {

const Command* find(const std::vector<Command>& commands, const std::string& name) {
  for (const Command& command : commands)
    if (command.name == name) return &command;
  return nullptr;
}

std::string command_list(const std::string& tool, const std::vector<Command>& commands) {
  std::string text = "usage: " + tool + " COMMAND ...\n\ncommands (each has --help):\n";
  for (const Command& command : commands)
    text += "  " + command.name + std::string(command.name.size() < 12 ? 12 - command.name.size() : 1, ' ') +
            command.summary + "\n";
  return text + "\n" + kExitCodeHelp;
}

}  // namespace

int dispatch(int argc, char** argv, const std::vector<Command>& commands) {
  const std::string tool = std::filesystem::path(argv[0]).filename().string();
  const std::string word = argc > 1 ? argv[1] : "";
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name);
  if (word == "--print-commands") {  // for scripts that walk over all tools; "" is the tool without a command
    for (const std::string& name : names) std::printf("%s\n", name.c_str());
    return kDone;
  }
  if (const Command* command = find(commands, word); command != nullptr && !word.empty())
    return command->run(argc - 1, argv + 1);
  if (const Command* unnamed = find(commands, "")) return unnamed->run(argc, argv);
  if (word == "-h" || word == "--help") {
    std::fputs(command_list(tool, commands).c_str(), stdout);
    return kDone;
  }
  if (word == "--version") {
    std::printf("%s %s\n", tool.c_str(), kVersion);
    return kDone;
  }
  std::fprintf(stderr, "%s: error: %s\n%s: hint: %s\n", tool.c_str(),
               word.empty() ? "no command given" : ("unknown command '" + word + "'").c_str(), tool.c_str(),
               suggestion(word, names).c_str());
  return int(ErrorCode::kUsage);
}

}  // namespace ngs::cli
