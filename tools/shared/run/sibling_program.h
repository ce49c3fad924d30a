#pragma once
// The other tools: programs in the folder of this one, or on Windows parts of it.
#include <string>
#include <vector>

namespace ngs::cli {

/// The command that begins with a tool and its arguments, with the path of the program that runs it. Throws
/// kEnvironment if the program is missing or not executable.
std::vector<std::string> sibling_command(std::vector<std::string> words);

/// Quotes `words` as a command line that a shell splits into the same words.
std::string quoted_line(const std::vector<std::string>& words);

}  // namespace ngs::cli
