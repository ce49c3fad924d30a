#include "shared/os/background.h"

namespace ngs::os {

std::thread in_background(const std::function<void()>& work) { return std::thread(work); }

}  // namespace ngs::os
