#pragma once
// Options that were given and that nothing listens to. A sweep over one of them would be a flat line without a word.
#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>

#include "shared/changed_options.h"
#include "shared/tool.h"

namespace ngs::cli {

/// "--component-neighbours: not used without --min-component", where one of `names` was given.
template <class Options>
void warn_unused(Run& run, const Options& options, std::initializer_list<std::string_view> names, const std::string& why) {
  std::string text;
  for (const auto& [name, value] : changed_options(options))
    if (std::find(names.begin(), names.end(), name) != names.end()) text += (text.empty() ? "" : ", ") + option_flag(name);
  if (!text.empty()) run.monitor().warn(text + ": not used " + why);
}

}  // namespace ngs::cli
