#pragma once
// The inputs, outputs and plain arguments that a tool declares in addition to its options.
#include <string>
#include <vector>

namespace ngs::cli {

struct Input {
  std::string name, help;  // name: a positional name or a flag such as "--field"
  bool required = true;
  std::string also = {};  // a second flag for the same input, such as "--model"; empty: none
  std::string path = {};  // empty: not given
  explicit operator bool() const { return !path.empty(); }
};

struct Inputs {  // positional: one or more paths after the other positionals; flag: any number of paths
  std::string name, help;
  std::vector<std::string> paths;
  bool is_flag() const { return name[0] == '-'; }
  explicit operator bool() const { return !paths.empty(); }
};

struct Output {
  std::string flags, help;  // "-o,--output"
  bool required = true;
  bool directory = false;  // created by the tool; must be absent or empty unless -w
  bool resumes = false;    // a folder that may contain the state of an earlier run, which the tool checks and continues
  std::string path = {};   // empty: not given
  explicit operator bool() const { return !path.empty(); }
  std::string long_flag() const { return flags.substr(flags.find("--")); }
};

struct Argument {  // a positional argument that is not a path
  std::string name, help, value;
};

}  // namespace ngs::cli
