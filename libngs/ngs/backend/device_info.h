#pragma once
// Whether this build and this machine can run on a GPU.
#include <string>

namespace ngs {

struct DeviceInfo {
  bool usable = false;
  std::string name;    // of the device, where usable
  std::string reason;  // why not, where not
};

DeviceInfo cuda_device();

}  // namespace ngs
