#include "ngs/stages/joint_options.h"

#include <algorithm>

#include "ngs/core/error.h"

namespace ngs {

JointEffects parse_effects(const std::vector<std::string>& entries) {
  JointEffects effects;
  for (const std::string& entry : entries) {
    const std::size_t equals = std::min(entry.find('='), entry.size());
    const std::string name = entry.substr(0, equals),
                      value = entry.substr(std::min(equals + 1, entry.size()));
    const auto* known = std::find_if(std::begin(kEffects), std::end(kEffects),
                                     [&](const EffectName& e) { return e.name == name; });
    if (known == std::end(kEffects) || (value != "auto" && value != "on" && value != "off")) {
      std::string names;
      for (const EffectName& e : kEffects) names += (names.empty() ? "" : ", ") + std::string(e.name);
      throw Error(ErrorCode::kUsage, "--effect: '" + entry + "', expected NAME=auto|on|off",
                  "NAME is one of " + names);
    }
    if (value != "auto") effects.*known->member = value == "on";
  }
  return effects;
}

}  // namespace ngs
