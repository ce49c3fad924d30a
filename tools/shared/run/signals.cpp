#include "shared/run/signals.h"

#include <signal.h>
#include <unistd.h>

#include "ngs/io/files/unfinished_files.h"
#include "shared/cli/exit_code.h"

namespace ngs::cli {
namespace {

std::atomic<bool> stop{false};
std::atomic<int> exit_code{0};
std::atomic<bool> ends_on_request{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may touch nothing else");

void on_signal(int number) {
  const int code = number == SIGINT || number == SIGQUIT ? kInterrupted : kTerminated;
  exit_code = code;
  if (number != SIGQUIT && !stop.exchange(true) && ends_on_request) return;
  io::remove_unfinished_files();
  _exit(code);
}

}  // namespace

void install_signal_handlers(bool on_request) {
  ends_on_request = on_request;
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;  // library code does not expect EINTR
  for (const int number : {SIGINT, SIGTERM, SIGUSR1, SIGQUIT}) sigaction(number, &action, nullptr);
  struct sigaction hangup = {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // ignored by nohup: goes on
  signal(SIGCHLD, SIG_DFL);  // a caller that ignores it passes that on, and the exit codes of children are lost
  for (const int number : {SIGPIPE, SIGXFSZ}) signal(number, SIG_IGN);  // reported like any failed write
}

const std::atomic<bool>& stop_flag() { return stop; }
int signal_exit_code() { return exit_code; }

}  // namespace ngs::cli
