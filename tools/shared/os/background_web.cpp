#include "shared/os/background.h"

namespace ngs::os {

std::thread in_background(const std::function<void()>& work) {
  work();
  return {};
}

}  // namespace ngs::os
