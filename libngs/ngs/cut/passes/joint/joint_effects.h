#pragma once
// The effects of the joint optimisation: the optimisation itself, and its parts.
#include <vector>

#include "ngs/cut/passes/effect.h"
#include "ngs/cut/training/joint_switches.h"

namespace ngs {

/// The effect of the whole pass comes first.
std::vector<Effect> joint_effects();

/// `on(name)` returns whether that part is on.
JointSwitches joint_switches(const std::function<bool(std::string_view)>& on);

}  // namespace ngs
