#pragma once
// Lists of names in texts.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace ngs {

/// "a, b and 7 more": the first `max_count` names.
inline std::string listed(const std::vector<std::string>& names, std::size_t max_count) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), max_count); ++i) text += (i > 0 ? ", " : "") + names[i];
  return names.size() > max_count ? text + " and " + std::to_string(names.size() - max_count) + " more" : text;
}

/// The parts between separators, at least one; parts may be empty. They point into `text`.
inline std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

}  // namespace ngs
