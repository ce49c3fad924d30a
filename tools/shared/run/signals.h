#pragma once
// SIGINT, SIGTERM, SIGUSR1 (the schedulers' early warning), SIGHUP where it is not ignored, and SIGQUIT.
#include <atomic>

namespace ngs::cli {

/// With `on_request` the first signal only sets stop_flag(); a second one, SIGQUIT, or any signal without it, removes
/// unfinished output files and ends the process with 130 or 143. SIGCHLD gets its default back.
void install_signal_handlers(bool on_request);
const std::atomic<bool>& stop_flag();
/// 0 without a signal, 130 after SIGINT, 143 after SIGTERM, SIGUSR1 or SIGHUP.
int signal_exit_code();

}  // namespace ngs::cli
