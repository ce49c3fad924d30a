#include "ngs/backend/device_info.h"

namespace ngs {

DeviceInfo cuda_device() {
  return {.usable = false,
          .name = {},
          .reason = "this build has no CUDA (configure it with -DNGS_WITH_CUDA=ON)",
          .free_bytes = 0};
}

void release_freed_device_memory() {}

}  // namespace ngs
