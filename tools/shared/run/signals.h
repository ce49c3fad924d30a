#pragma once
// SIGINT, SIGTERM, SIGUSR1 (the schedulers' early warning), SIGHUP where it is not ignored, and SIGQUIT: the process
// ends within a second, in any phase and at any size, and nothing half-written stays.
#include <atomic>

namespace ngs::cli {

/// With `on_request` the first signal sets stop_flag() and gives the body 0.3 s to end in its own way. After
/// that, at a second signal, at SIGQUIT, and at any signal without `on_request`, unfinished output files are removed
/// and the process ends with 130 or 143. SIGCHLD gets its default back.
void install_signal_handlers(bool on_request);
const std::atomic<bool>& stop_flag();
/// 0 without a signal, 130 after SIGINT, 143 after SIGTERM, SIGUSR1 or SIGHUP.
int signal_exit_code();

/// The body has ended: what is left, the report, is not cut off.
void let_finish();

/// For as long as one lives, the body has something to keep, a checkpoint: a first signal gives it the time that it
/// takes. One at a time.
class KeepsState {
 public:
  KeepsState();
  ~KeepsState();
  KeepsState(const KeepsState&) = delete;
  KeepsState& operator=(const KeepsState&) = delete;
};

}  // namespace ngs::cli
