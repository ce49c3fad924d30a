#include <omp.h>

#include <cstdlib>

#include "shared/os/machine.h"

namespace ngs::os {

int processor_count() { return omp_get_max_threads(); }
std::thread in_background(const std::function<void()>& work) {
  work();
  return {};
}
void set_variable(const char* name, const char* value, bool replace) { setenv(name, value, replace ? 1 : 0); }
void keep_freed_memory() {}
void release_freed_memory() {}
std::string path_of_this_program() { return "/bin/ngs-studio"; }
std::vector<std::string> browser_command(const std::string& url) { return {"xdg-open", url}; }
bool is_terminal(int) { return false; }
int terminal_width(int) { return 0; }

}  // namespace ngs::os
