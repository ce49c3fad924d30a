#pragma once
// Whether this build and this machine can run on a GPU.
#include <string>

namespace ngs {

struct DeviceInfo {
  bool usable = false;
  std::string name;    // of the device, if there is one
  std::string reason;  // why it is unusable
  double free_bytes = 0;
};

DeviceInfo cuda_device();

/// Lets other processes have the device memory that this one has freed, and otherwise keeps for its later allocations.
void release_freed_device_memory();

}  // namespace ngs
