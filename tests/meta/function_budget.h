#pragma once
// Size limits of functions, and exceptions with reasons.
#include <map>
#include <string>

#include "support/cpp_functions.h"

namespace ngs::test {

inline constexpr int kFunctionLines = 60, kFunctionParameters = 5, kFunctionNesting = 4;
inline constexpr std::size_t kMaxExceptions = 10;

/// "path:function" -> reason for its size.
inline const std::map<std::string, std::string>& function_exceptions() {
  static const std::map<std::string, std::string> exceptions = {};
  return exceptions;
}

inline bool exceeds_budget(const CppFunction& f) {
  return f.lines > kFunctionLines || f.parameters > kFunctionParameters || f.nesting > kFunctionNesting;
}

}  // namespace ngs::test
