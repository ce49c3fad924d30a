#pragma once
// The other tools, which are installed in the folder of this one.
#include <string>
#include <vector>

namespace ngs::front {

struct Sibling {
  const char* command;  // "mask"
  const char* program;  // "ngs-mask"
  const char* summary;
};
/// In the order in which a run calls them.
const std::vector<Sibling>& siblings();

/// Becomes the program with these words behind its name: same process, so that signals, streams and the exit code are
/// its own. Comes back only by an Error (kEnvironment).
[[noreturn]] void become(const std::string& program, const std::vector<std::string>& words);

}  // namespace ngs::front
