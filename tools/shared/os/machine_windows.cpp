#include <io.h>
#include <malloc.h>
#include <windows.h>

#include <bit>
#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "ngs/os/windows_error.h"
#include "shared/os/machine.h"

namespace ngs::os {

int processor_count() {
  DWORD_PTR of_process = 0, of_system = 0;
  if (!GetProcessAffinityMask(GetCurrentProcess(), &of_process, &of_system) || of_process == 0) return 1;
  return std::popcount(of_process);
}

void set_variable(const char* name, const char* value, bool replace) {
  if (replace || std::getenv(name) == nullptr) _putenv_s(name, value);
}

void keep_freed_memory() {}
void release_freed_memory() { _heapmin(); }

std::string path_of_this_program() {
  std::wstring name(32768, L'\0');
  name.resize(GetModuleFileNameW(nullptr, name.data(), DWORD(name.size())));
  errno = name.empty() ? last_errno() : 0;
  return std::filesystem::path(name).generic_string();
}

std::thread in_background(const std::function<void()>& work) { return std::thread(work); }

std::vector<std::string> browser_command(const std::string& url) {
  return {"rundll32", "url.dll,FileProtocolHandler", url};
}

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
