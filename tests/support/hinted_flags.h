#pragma once
// Finds the flags in a tool's hints and warnings, the commands to which they belong, and complete commands.
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

/// Complete commands in the hints and warnings: a tool of ngs with at least one file, and no placeholder such as DIR,
/// MODEL.ply, X,Y,Z or "...". Each as words, without quotes. A command ends before prose: a word that is no flag, no
/// value of one, and no file.
std::vector<std::vector<std::string>> hinted_commands(const std::string& err);

/// Whether all input files of a complete command exist, relative to `folder`: it must then succeed.
bool has_its_inputs(const std::vector<std::string>& command, const std::string& folder);

}  // namespace ngs::test
