#include <windows.h>

#include "shared/os/stop_event.h"
#include "shared/os/stop_requests.h"

namespace ngs::os {
namespace {

void (*handle)(StopRequest) = nullptr;
void (*end_of_timer)() = nullptr;
HANDLE timer = nullptr;

BOOL WINAPI on_event(DWORD event) {
  handle(event == CTRL_C_EVENT ? StopRequest::kInterrupt : StopRequest::kTerminate);
  // When the console is closed, the process ends as soon as this function returns.
  if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) Sleep(INFINITE);
  return TRUE;
}

void CALLBACK on_timer(void*, BOOLEAN) { end_of_timer(); }

/// Another program of these has requested the end (process_windows.cpp): events of the console need a console.
void CALLBACK on_stop_event(void*, BOOLEAN) { handle(StopRequest::kTerminate); }

}  // namespace

void handle_stop_requests(void (*handler)(StopRequest)) {
  handle = handler;
  SetConsoleCtrlHandler(on_event, TRUE);
  const HANDLE stop = CreateEventW(nullptr, FALSE, FALSE, stop_event_of(GetCurrentProcessId()).c_str());
  HANDLE wait = nullptr;
  if (stop != nullptr) RegisterWaitForSingleObject(&wait, stop, on_stop_event, nullptr, INFINITE, WT_EXECUTEDEFAULT);
}

bool make_stop_timer(void (*on_end)()) {
  end_of_timer = on_end;
  return true;
}

void start_stop_timer(int milliseconds) {
  if (timer != nullptr) DeleteTimerQueueTimer(nullptr, timer, nullptr);
  timer = nullptr;
  if (milliseconds > 0) CreateTimerQueueTimer(&timer, nullptr, on_timer, nullptr, DWORD(milliseconds), 0, 0);
}

void end_now(int code) {
  TerminateProcess(GetCurrentProcess(), UINT(code));
  for (;;) Sleep(INFINITE);
}

}  // namespace ngs::os
