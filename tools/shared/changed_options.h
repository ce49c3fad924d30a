#pragma once
// Which options of a group somebody has chosen.
#include <string>
#include <utility>
#include <vector>

#include "ngs/options/option_set.h"

namespace ngs::cli {

/// Name and value of those that differ from their defaults; an options file repeats the others as well.
template <class Options>
std::vector<std::pair<std::string, Json>> changed_options(Options options, Options defaults = {}) {
  OptionSet given, unchanged;
  given.add(options), unchanged.add(defaults);
  std::vector<std::pair<std::string, Json>> changed;
  for (const OptionEntry& entry : given.entries())
    if (const Json value = entry.get(); value != unchanged.at(entry.name).get()) changed.emplace_back(entry.name, value);
  return changed;
}

}  // namespace ngs::cli
