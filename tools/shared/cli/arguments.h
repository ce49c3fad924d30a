#pragma once
// What a tool declares beside its options: what it reads and writes, and words.
#include <string>
#include <vector>

namespace ngs::cli {

struct Input {
  std::string name, help;  // name: a word (positional) or a flag such as "--field"
  bool required = true;
  std::string also = {};  // another flag of the same meaning, such as "--model"; empty: none
  std::string path = {};  // empty: not given
  explicit operator bool() const { return !path.empty(); }
};

struct Inputs {  // a word: one or more positional paths, behind the other positionals; a flag: any number of paths
  std::string name, help;
  std::vector<std::string> paths;
  bool is_flag() const { return name[0] == '-'; }
  explicit operator bool() const { return !paths.empty(); }
};

struct Output {
  std::string flags, help;  // "-o,--output"
  bool required = true;
  bool directory = false;  // made by the tool; must be absent or empty unless -w, which says what stays of before
  bool resumes = false;    // a folder: what an earlier run left there is gone on with, the tool looks what that is
  std::string path = {};   // empty: not given
  explicit operator bool() const { return !path.empty(); }
  std::string long_flag() const { return flags.substr(flags.find("--")); }
};

struct Argument {  // a positional word that is not a path
  std::string name, help, value;
};

}  // namespace ngs::cli
