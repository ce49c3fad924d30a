#pragma once
// Requests to stop from outside: signals, or events of the console.
#include <atomic>

namespace ngs::os {

enum class StopRequest {
  kInterrupt,  // Ctrl-C
  kQuit,       // SIGQUIT
  kTerminate   // SIGTERM, SIGUSR1, SIGHUP unless it is ignored; the console or the session ends
};

/// `handler` runs in a signal handler, on Windows in a thread. Also resets SIGCHLD; failed writes raise no signals.
void handle_stop_requests(void (*handler)(StopRequest));
/// Prepares a timer that calls `on_end`, as above. False: there is no timer.
bool make_stop_timer(void (*on_end)());
/// 0: never. Async-signal-safe.
void start_stop_timer(int milliseconds);
[[noreturn]] void end_now(int code);

}  // namespace ngs::os
