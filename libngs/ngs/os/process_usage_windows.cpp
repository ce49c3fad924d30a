#include "ngs/os/process_usage.h"

// clang-format off
#include <windows.h>  // before psapi.h
#include <psapi.h>
// clang-format on

namespace ngs::os {

double cpu_seconds() {
  FILETIME created, ended, kernel{}, user{};
  GetProcessTimes(GetCurrentProcess(), &created, &ended, &kernel, &user);
  const auto seconds = [](const FILETIME& t) { return 1e-7 * (4294967296.0 * t.dwHighDateTime + t.dwLowDateTime); };
  return seconds(kernel) + seconds(user);
}

double peak_rss_mib() {
  PROCESS_MEMORY_COUNTERS memory{};
  GetProcessMemoryInfo(GetCurrentProcess(), &memory, sizeof memory);
  return double(memory.PeakWorkingSetSize) / (1 << 20);
}

}  // namespace ngs::os
