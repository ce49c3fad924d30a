#include <io.h>
#include <windows.h>

#include "shared/os/terminal.h"

namespace ngs::os {

/// _isatty() is also true for NUL.
bool is_terminal(int descriptor) {
  DWORD mode = 0;
  return GetConsoleMode(HANDLE(_get_osfhandle(descriptor)), &mode) != 0;
}

int terminal_width(int descriptor) {
  CONSOLE_SCREEN_BUFFER_INFO screen{};
  if (!GetConsoleScreenBufferInfo(HANDLE(_get_osfhandle(descriptor)), &screen)) return 0;
  return screen.srWindow.Right - screen.srWindow.Left + 1;
}

}  // namespace ngs::os
