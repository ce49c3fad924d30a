#pragma once
// The joint optimisation as an effect, and the parts of it that can be switched.
#include <vector>

#include "ngs/passes/effect.h"
#include "ngs/stages/optimise/joint_switches.h"

namespace ngs {

/// The pass itself first.
std::vector<Effect> joint_effects();

/// `on(name)`: whether that part is on.
JointSwitches joint_switches(const std::function<bool(std::string_view)>& on);

}  // namespace ngs
