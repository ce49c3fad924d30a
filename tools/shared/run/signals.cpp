#include "shared/run/signals.h"

#include "ngs/io/files/atomic_file.h"
#include "shared/cli/exit_code.h"
#include "shared/os/stop_requests.h"

namespace ngs::cli {
namespace {

std::atomic<bool> stop{false};
std::atomic<int> exit_code{0};
std::atomic<bool> ends_on_request{false}, grace_extended{false};
constexpr int kGraceMs = 300;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may use lock-free atomics only");

void end_process(int code) {
  io::remove_unfinished_files();
  os::end_now(code);
}

void on_request(os::StopRequest request) {
  const int code = request == os::StopRequest::kTerminate ? kTerminated : kInterrupted;
  exit_code = code;
  if (request == os::StopRequest::kQuit || stop.exchange(true) || !ends_on_request) end_process(code);
  if (!grace_extended) os::start_stop_timer(kGraceMs);
}

}  // namespace

void install_signal_handlers(bool waits_for_body) {
  // Without a timer a slow body would never end.
  if (waits_for_body) ends_on_request = os::make_stop_timer([] { end_process(exit_code); });
  os::handle_stop_requests(on_request);
}

const std::atomic<bool>& stop_flag() { return stop; }
int signal_exit_code() { return exit_code; }

void cancel_grace_timer() {
  if (ends_on_request) os::start_stop_timer(0);
}

SignalGrace::SignalGrace() { grace_extended = true; }
SignalGrace::~SignalGrace() {
  grace_extended = false;
  if (stop && ends_on_request) os::start_stop_timer(kGraceMs);
}

}  // namespace ngs::cli
