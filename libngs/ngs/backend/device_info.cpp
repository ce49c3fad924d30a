#include "ngs/backend/device_info.h"

#include "ngs/backend/exec.h"

namespace ngs {

DeviceInfo cuda_device() {
  static_assert(!kWithCuda, "a build with the CUDA backend defines this function in device_info_cuda.cu");
  return {.usable = false, .name = {}, .reason = "no stage of this version runs on CUDA"};
}

}  // namespace ngs
