#include "shared/run/signals.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <initializer_list>

#include "ngs/io/files/unfinished_files.h"
#include "shared/cli/exit_code.h"

namespace ngs::cli {
namespace {

std::atomic<bool> stop{false};
std::atomic<int> exit_code{0};
std::atomic<bool> ends_on_request{false}, grace_extended{false};
timer_t grace{};  // ends the process; created before a handler can run
constexpr long kGraceNs = 300'000'000;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may use lock-free atomics only");

void end_process(int code) {
  io::remove_unfinished_files();
  _exit(code);
}

/// 0: never.
void end_in(long ns) {
  const itimerspec when{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_nsec = ns}};
  timer_settime(grace, 0, &when, nullptr);
}

void on_signal(int number) {
  const int code = number == SIGINT || number == SIGQUIT ? kInterrupted : kTerminated;
  exit_code = code;
  if (number == SIGQUIT || stop.exchange(true) || !ends_on_request) end_process(code);
  if (!grace_extended) end_in(kGraceNs);
}

void on_grace_over(int) { end_process(exit_code); }

void make_grace_timer() {
  struct sigaction action = {};
  action.sa_handler = on_grace_over;
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  sigset_t alarm;  // inherited from a parent process that blocks it
  sigemptyset(&alarm), sigaddset(&alarm, SIGALRM);
  pthread_sigmask(SIG_UNBLOCK, &alarm, nullptr);
  sigevent event = {};
  event.sigev_notify = SIGEV_SIGNAL, event.sigev_signo = SIGALRM;
  ends_on_request = timer_create(CLOCK_MONOTONIC, &event, &grace) == 0;  // without a timer a slow body would never end
}

}  // namespace

void install_signal_handlers(bool on_request) {
  if (on_request) make_grace_timer();
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;  // library code does not expect EINTR
  for (const int number : {SIGINT, SIGTERM, SIGUSR1, SIGQUIT}) sigaction(number, &action, nullptr);
  struct sigaction hangup = {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup ignores it: keep running
  signal(SIGCHLD, SIG_DFL);  // inherited if the parent ignores it; exit codes of children would be lost
  for (const int number : {SIGPIPE, SIGXFSZ}) signal(number, SIG_IGN);  // reported like any failed write
}

const std::atomic<bool>& stop_flag() { return stop; }
int signal_exit_code() { return exit_code; }

void cancel_grace_timer() {
  if (ends_on_request) end_in(0);
}

SignalGrace::SignalGrace() { grace_extended = true; }
SignalGrace::~SignalGrace() {
  grace_extended = false;
  if (stop && ends_on_request) end_in(kGraceNs);
}

}  // namespace ngs::cli
