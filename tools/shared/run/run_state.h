#pragma once
// The data behind a Run. Internal to tools/shared.
#include <vector>

#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"
#include "shared/run/console.h"
#include "shared/run/environment.h"
#include "shared/run/report.h"
#include "shared/run/streams.h"

namespace ngs::cli {

struct RunState {
  const Spec& spec;
  const Streams& streams;
  const CommonFlags& flags;
  Console& console;
  ChosenDevice device;
  Exec exec = {};
  bool is_restart = false;
  Monitor monitor = {};
  std::vector<ReadInput> inputs = {};
  Json result = Json::object();
  Json plan = Json::object();

  /// From now on the run uses the CPU instead of the device that --device auto chose.
  void use_cpu(const std::string& why) {
    exec = exec.on_cpu();
    device = {Device::kCpu, "cpu", "auto: " + why};
    console.info("device: cpu (" + device.reason + ")");
  }
  /// The device's memory did not suffice for `part`, which will start again on the CPU. Rethrows if --device cuda or
  /// --fast-atomics demands the device. For a catch block.
  void leave_device(const OutOfDeviceMemory& e, const std::string& part) {
    if (flags.device != DeviceChoice::kAuto || device.sums == DeviceSums::kAtomic) throw;
    monitor.warn(std::string(e.what()) + ": " + part + " starts again on the CPU");
    use_cpu(device.name + " has too little memory");
  }
};

}  // namespace ngs::cli
