#pragma once
// Finds the flags in a tool's hints and warnings, and the commands to which they belong.
#include <string>
#include <vector>

namespace ngs::test {

struct HintedFlag {
  std::vector<std::vector<std::string>>
      commands;      // {"ngs-scene", "import"}: commands in the sentence, and the tool itself
  std::string flag;  // "--mask-invert"
};

/// Parses the lines "TOOL [COMMAND]: hint: ..." and "...: warning: ..." of a tool's stderr. Flags of foreign programs
/// are skipped. The word "import" in a sentence means ngs-scene import.
std::vector<HintedFlag> hinted_flags(const std::string& err);

/// Whether the help of one of the commands lists the flag.
bool has_flag(const HintedFlag& hinted);

}  // namespace ngs::test
