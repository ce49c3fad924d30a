#include <cstdlib>

#include "shared/os/stop_requests.h"

namespace ngs::os {

// A page stops a module from outside.
void handle_stop_requests(void (*)(StopRequest)) {}
bool make_stop_timer(void (*)()) { return false; }
void start_stop_timer(int) {}
void end_now(int code) { std::_Exit(code); }

}  // namespace ngs::os
