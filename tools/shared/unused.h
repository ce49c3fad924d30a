#pragma once
// Options that were given and that nothing listens to. A sweep over one of them would be a flat line without a word.
#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "shared/changed_options.h"
#include "shared/tool.h"

namespace ngs::cli {

/// The flags of all that were given of a group whose names have this prefix.
template <class Options>
std::vector<std::string> given_flags(const Options& options, const Options& defaults = {}, const std::string& prefix = {}) {
  std::vector<std::string> flags;
  for (const auto& [name, value] : changed_options(options, defaults)) flags.push_back(option_flag(prefix + name));
  return flags;
}

/// "--component-neighbours: not used without --min-component", where there are flags.
inline void warn_unused(Run& run, const std::vector<std::string>& flags, const std::string& why) {
  std::string text;
  for (const std::string& flag : flags) text += (text.empty() ? "" : ", ") + flag;
  if (!text.empty()) run.monitor().warn(text + ": not used " + why);
}

/// The same of those of `names` that were given.
template <class Options>
void warn_unused(Run& run, const Options& options, std::initializer_list<std::string_view> names, const std::string& why) {
  std::vector<std::string> flags;
  for (const auto& [name, value] : changed_options(options))
    if (std::find(names.begin(), names.end(), name) != names.end()) flags.push_back(option_flag(name));
  warn_unused(run, flags, why);
}

}  // namespace ngs::cli
