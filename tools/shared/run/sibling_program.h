#pragma once
// The other tools, which are installed in the folder of this one.
#include <string>
#include <vector>

namespace ngs::cli {

/// The path of a program beside this one. kEnvironment where it is not there or cannot be run.
std::string sibling_path(const std::string& program);

/// Words as a line that a shell takes apart into the same words.
std::string quoted_line(const std::vector<std::string>& words);

}  // namespace ngs::cli
