#pragma once
// The flags that a tool's hints and warnings name, and the commands that they belong to.
#include <string>
#include <vector>

namespace ngs::test {

struct HintedFlag {
  std::vector<std::vector<std::string>>
      commands;      // {"ngs-scene", "import"}: those that the sentence names, and its tool
  std::string flag;  // "--mask-invert"
};

/// Of the lines "TOOL [COMMAND]: hint: ..." and "...: warning: ..." of a tool's stderr. Flags of programs that are not
/// ours are left out. A sentence that says "import" names ngs-scene import.
std::vector<HintedFlag> hinted_flags(const std::string& err);

/// Whether the help of one of the commands lists the flag.
bool has_flag(const HintedFlag& hinted);

}  // namespace ngs::test
