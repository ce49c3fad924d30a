#pragma once
// Executes a run, from the checks of its paths to its report.
#include <functional>

#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"
#include "shared/run/console.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct RunState;

/// Runs the body. If the device's memory does not suffice, and --device auto chose the device, the body runs again on
/// the CPU, with a warning. Throws OutOfDeviceMemory if --device cuda or --fast-atomics demands the device.
int run_on_device_or_cpu(RunState& state, const std::function<int(Run&)>& body);

/// Returns the exit code of the body.
int execute(Spec& spec, const CommonFlags& flags, Console& console, const std::function<int(Run&)>& body);

}  // namespace ngs::cli
