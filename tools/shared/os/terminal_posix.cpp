#include <sys/ioctl.h>
#include <unistd.h>

#include "shared/os/terminal.h"

namespace ngs::os {

bool is_terminal(int descriptor) { return ::isatty(descriptor) != 0; }

int terminal_width(int descriptor) {
  winsize size{};
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace ngs::os
