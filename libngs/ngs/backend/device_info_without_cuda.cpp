#include "ngs/backend/device_info.h"

namespace ngs {

DeviceInfo cuda_device() {
  return {.usable = false, .name = {}, .reason = "this build has no CUDA (configure it with -DNGS_WITH_CUDA=ON)"};
}

}  // namespace ngs
