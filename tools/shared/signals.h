#pragma once
// SIGINT, SIGTERM and SIGUSR1 (the schedulers' early warning).
#include <atomic>

namespace ngs::cli {

/// With `on_request` the first signal only sets stop_flag(); a second one, or any signal without it, removes
/// unfinished output files and ends the process with 130 or 143.
void install_signal_handlers(bool on_request);
const std::atomic<bool>& stop_flag();
/// 0 without a signal, 130 after SIGINT, 143 after SIGTERM or SIGUSR1.
int signal_exit_code();

}  // namespace ngs::cli
