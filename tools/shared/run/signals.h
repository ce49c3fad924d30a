#pragma once
// Handles SIGINT, SIGTERM, SIGUSR1 (the early warning of schedulers), SIGHUP unless it is ignored, and SIGQUIT. The
// process ends within one second, in any phase and for any scene size, and leaves no half-written file.
#include <atomic>

namespace ngs::cli {

/// With `on_request` the first signal sets stop_flag() and the body has 0.3 s to return. After these 0.3 s, on a second
/// signal, on SIGQUIT, and on any signal without `on_request`, unfinished output files are removed and the process ends
/// with 130 or 143. Also resets SIGCHLD to its default.
void install_signal_handlers(bool on_request);
const std::atomic<bool>& stop_flag();
/// 0 without a signal, 130 after SIGINT, 143 after SIGTERM, SIGUSR1 or SIGHUP.
int signal_exit_code();

/// To be called when the body has returned, so that the timer does not interrupt the writing of the report.
void cancel_grace_timer();

/// While an instance exists, the first signal starts no timer: the body may take as long as it needs, for instance to
/// write a checkpoint. At most one instance at a time.
class SignalGrace {
 public:
  SignalGrace();
  ~SignalGrace();
  SignalGrace(const SignalGrace&) = delete;
  SignalGrace& operator=(const SignalGrace&) = delete;
};

}  // namespace ngs::cli
