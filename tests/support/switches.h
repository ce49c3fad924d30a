#pragma once
// Parts of the method switched on or off by name, as with --effect.
#include <string>
#include <vector>

#include "ngs/cut/contours/contour_options.h"
#include "ngs/cut/passes/effect.h"
#include "ngs/cut/passes/joint/joint_effects.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/pipeline.h"

namespace ngs::test {

inline EffectSwitches switches_of(const std::vector<std::string>& entries) {
  return {Pipeline(all_passes()).effects(), entries};
}

/// auto counts as on.
inline JointSwitches joint_switched(const std::vector<std::string>& entries) {
  const EffectSwitches switches = switches_of(entries);
  return joint_switches([&](std::string_view name) { return switches.of(name) != Switch::kOff; });
}

inline ContourSwitches contours_switched(const std::vector<std::string>& entries) {
  const EffectSwitches switches = switches_of(entries);
  const auto on = [&](std::string_view name) { return switches.of(name) != Switch::kOff; };
  return {.split = on("split"), .iterations = on("contour-iterations"), .full_resolution = on("full-resolution")};
}

}  // namespace ngs::test
