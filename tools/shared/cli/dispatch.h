#pragma once
// Sub-commands: "ngs-scene import ..." runs the entry "import" with argv moved by one.
#include <functional>
#include <string>
#include <vector>

namespace ngs::cli {

struct Command {
  std::string name;                     // empty: runs where argv[1] is none of the others
  std::function<int(int, char**)> run;  // makes its own Tool, named "ngs-scene import"
  std::string summary = {};
};

/// Returns the exit code of the command, or answers -h, --help, --version [--json] and --print-commands itself.
int dispatch(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace ngs::cli
