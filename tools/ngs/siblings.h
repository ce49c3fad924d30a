#pragma once
// The other tools, which are installed in the folder of this one.
#include <string>
#include <vector>

namespace ngs::ngs_tool {

struct Sibling {
  const char* command;  // "mask"
  const char* program;  // "ngs-mask"
  const char* summary;
};
/// All tools, in the order in which a run calls them.
const std::vector<Sibling>& siblings();

/// Replaces this process by the program with these arguments (exec), so that signals, streams and exit code are those
/// of the program. Returns only by throwing kEnvironment.
[[noreturn]] void exec_program(const std::string& program, const std::vector<std::string>& words);

}  // namespace ngs::ngs_tool
