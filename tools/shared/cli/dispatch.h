#pragma once
// Sub-commands: "ngs-scene import ..." runs the entry "import" with argv shifted by one.
#include <functional>
#include <string>
#include <vector>

namespace ngs::cli {

struct Command {
  std::string name;                     // empty: runs if argv[1] is no other command
  std::function<int(int, char**)> run;  // creates its own Tool, named "ngs-scene import"
  std::string summary = {};
};

/// Returns the exit code of the command. Handles -h, --help, --version [--json] and --print-commands itself.
int dispatch(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace ngs::cli
