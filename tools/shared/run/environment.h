#pragma once
// What the machine and the environment variables say: threads and device.
#include <string>

#include "ngs/backend/exec.h"
#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"

namespace ngs::cli {

/// -j unless 0, else NGS_THREADS, else SLURM_CPUS_PER_TASK, else the CPUs that this process may run on.
int choose_threads(int flag);

/// NGS_ISA = portable, neon, v3 or v4, else the best that processor and build have. Throws where the one asked for
/// cannot be had.
Isa choose_isa();
const char* isa_name(Isa isa);

struct ChosenDevice {
  Device device = Device::kCpu;
  std::string name;    // "cpu" or the GPU's name
  std::string reason;  // why this one
  DeviceSums sums = DeviceSums::kInOrder;
};
/// Throws kEnvironment where CUDA is asked for and cannot be had, by the machine, the build or the tool. auto is the
/// CPU: the CUDA path has not been run on a device yet.
ChosenDevice choose_device(DeviceChoice choice, const Spec& tool);

}  // namespace ngs::cli
