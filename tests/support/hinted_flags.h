#pragma once
// The flags that a tool's hints and warnings name, and the commands that they belong to.
#include <string>
#include <vector>

namespace ngs::test {

struct HintedFlag {
  std::vector<std::string> command;  // {"ngs-scene", "import"}
  std::string flag;                  // "--mask-invert"
};

/// Of the lines "TOOL [COMMAND]: hint: ..." and "...: warning: ..." of a tool's stderr. A flag belongs to the command
/// that the text names before it, in the same sentence, else to the one that says it; those of programs that are not
/// ours are left out.
std::vector<HintedFlag> hinted_flags(const std::string& err);

/// Whether the command's help lists the flag.
bool has_flag(const HintedFlag& hinted);

}  // namespace ngs::test
