#pragma once
// Number of threads, instruction set and device, from flags, environment variables and the machine.
#include <string>
#include <string_view>

#include "ngs/backend/exec.h"
#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"

namespace ngs::cli {

/// -j unless 0, else NGS_THREADS, else SLURM_CPUS_PER_TASK, else the CPUs that this process may run on.
int choose_threads(int flag);

/// NGS_ISA = portable, neon, v3 or v4, else the best that processor and build support. Throws if NGS_ISA is
/// unsupported.
Isa choose_isa();
const char* isa_name(Isa isa);

/// The tools whose ops have a device path, and which declare it by Tool::runs_on_device().
bool has_device_path(std::string_view tool);

struct ChosenDevice {
  Device device = Device::kCpu;
  std::string name;    // "cpu" or the GPU's name
  std::string reason;  // why it was chosen
  double free_bytes = 0;
  DeviceSums sums = DeviceSums::kInOrder;
};
/// kEnvironment if CUDA is requested but machine, build or tool does not support it. auto is the GPU if there is one.
ChosenDevice choose_device(DeviceChoice choice, const Spec& tool);

}  // namespace ngs::cli
