#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <initializer_list>

#include "shared/os/stop_requests.h"

namespace ngs::os {
namespace {

void (*handle)(StopRequest) = nullptr;  // set before a signal handler can run
void (*end_of_timer)() = nullptr;
timer_t timer{};

void on_signal(int number) {
  handle(number == SIGINT ? StopRequest::kInterrupt : number == SIGQUIT ? StopRequest::kQuit : StopRequest::kTerminate);
}

void on_alarm(int) { end_of_timer(); }

}  // namespace

void handle_stop_requests(void (*handler)(StopRequest)) {
  handle = handler;
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

bool make_stop_timer(void (*on_end)()) {
  end_of_timer = on_end;
  struct sigaction action = {};
  action.sa_handler = on_alarm;
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  sigset_t alarm;  // inherited from a parent process that blocks it
  sigemptyset(&alarm);
  sigaddset(&alarm, SIGALRM);
  pthread_sigmask(SIG_UNBLOCK, &alarm, nullptr);
  sigevent event = {};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGALRM;
  return timer_create(CLOCK_MONOTONIC, &event, &timer) == 0;
}

void start_stop_timer(int milliseconds) {
  const itimerspec when{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_nsec = 1'000'000L * milliseconds}};
  timer_settime(timer, 0, &when, nullptr);
}

void end_now(int code) { _exit(code); }

}  // namespace ngs::os
