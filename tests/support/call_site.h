#pragma once
// The place that called a check, as the default argument of its last parameter. std::source_location needs clang 15 or
// newer.
#include <string>

namespace ngs::test {

struct CallSite {
  const char* file;
  int line;

  static CallSite current(const char* file = __builtin_FILE(), int line = __builtin_LINE()) { return {file, line}; }
  std::string text() const { return std::string(file) + ":" + std::to_string(line); }
};

}  // namespace ngs::test
