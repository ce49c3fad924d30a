#include <malloc.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "shared/os/machine.h"

namespace ngs::os {

int processor_count() {
  cpu_set_t cpus;
  if (sched_getaffinity(0, sizeof cpus, &cpus) != 0) return 1;
  return std::max(1, CPU_COUNT(&cpus));
}

void set_variable(const char* name, const char* value, bool replace) { setenv(name, value, replace ? 1 : 0); }

void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 16 << 20);  // whole pages of 2 MiB (start/large_pages.cpp)
}

void release_freed_memory() { malloc_trim(0); }

std::string path_of_this_program() {
  std::error_code unknown;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", unknown);
  errno = unknown.value();
  return unknown ? std::string() : self.string();
}

std::thread in_background(const std::function<void()>& work) { return std::thread(work); }

std::vector<std::string> browser_command(const std::string& url) { return {"xdg-open", url}; }

bool is_terminal(int descriptor) { return ::isatty(descriptor) != 0; }

int terminal_width(int descriptor) {
  winsize size{};
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace ngs::os
