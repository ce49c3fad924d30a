#pragma once
// Parts of the method switched on or off by name, as with --effect.
#include <set>
#include <string>
#include <vector>

#include "ngs/cut/contours/contour_options.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/pipeline.h"
#include "ngs/cut/training/effect.h"

namespace ngs::test {

inline EffectSwitches switches_of(const std::vector<std::string>& entries) {
  return {Pipeline(all_passes()).effects(), entries};
}

/// JointOptions::off; auto counts as on.
inline std::set<std::string, std::less<>> joint_switched(const std::vector<std::string>& entries) {
  const EffectSwitches switches = switches_of(entries);
  std::set<std::string, std::less<>> off;
  for (const Effect& effect : Pipeline(all_passes()).effects())
    if (switches.of(effect.name) == Switch::kOff) off.emplace(effect.name);
  return off;
}

inline ContourSwitches contours_switched(const std::vector<std::string>& entries) {
  const EffectSwitches switches = switches_of(entries);
  const auto on = [&](std::string_view name) { return switches.of(name) != Switch::kOff; };
  return {.split = on("split"), .iterations = on("contour-iterations"), .full_resolution = on("full-resolution")};
}

}  // namespace ngs::test
