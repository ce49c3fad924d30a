#pragma once
// The other tools, which are installed in the folder of this one.
#include <string>
#include <vector>

namespace ngs::cli {

/// The path of a program in the folder of this executable. Throws kEnvironment if it is missing or not executable.
std::string sibling_path(const std::string& program);

/// Quotes `words` as a command line that a shell splits into the same words.
std::string quoted_line(const std::vector<std::string>& words);

}  // namespace ngs::cli
