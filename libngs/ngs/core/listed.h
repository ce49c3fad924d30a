#pragma once
// Lists of names in messages.
#include <algorithm>
#include <string>
#include <vector>

namespace ngs {

/// "a, b and 7 more": the first `most` names.
inline std::string listed(const std::vector<std::string>& names, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i > 0 ? ", " : "") + names[i];
  return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " more" : text;
}

}  // namespace ngs
