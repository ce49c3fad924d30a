#pragma once
// Numbers in texts.
#include <cstdio>
#include <string>

namespace ngs {

/// `value` by a pattern of printf for one double, "%.4g"; at most 63 characters.
inline std::string formatted(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

/// A share of 1 in percent, three digits: "12.5 %".
inline std::string percent(double share) { return formatted("%.3g %%", 100 * share); }

}  // namespace ngs
