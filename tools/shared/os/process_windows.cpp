#include <fcntl.h>
#include <io.h>
#include <windows.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

#include "ngs/os/windows_error.h"
#include "shared/os/process.h"
#include "shared/os/stop_event.h"

namespace ngs::os {
namespace {

/// Quotes a word so that the C library of the child parses the same word.
std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n\v\"") == word.npos) return word;
  std::string text = "\"";
  std::size_t backslashes = 0;
  for (const char c : word) {
    if (c == '"') text.append(backslashes + 1, '\\');
    backslashes = c == '\\' ? backslashes + 1 : 0;
    text += c;
  }
  return text.append(backslashes, '\\') + '"';
}

HANDLE inheritable(int descriptor, DWORD access) {
  if (descriptor < 0) {
    SECURITY_ATTRIBUTES inherit{sizeof inherit, nullptr, TRUE};
    return CreateFileW(L"NUL", access, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherit, OPEN_EXISTING, 0, nullptr);
  }
  HANDLE copy = nullptr;
  const HANDLE self = GetCurrentProcess();
  DuplicateHandle(self, HANDLE(_get_osfhandle(descriptor)), self, &copy, 0, TRUE, DUPLICATE_SAME_ACCESS);
  return copy;
}

bool open_pipe(int& reading, int& writing) {
  HANDLE read = nullptr, write = nullptr;
  if (!CreatePipe(&read, &write, nullptr, 1 << 16)) {
    errno = last_errno();
    return false;
  }
  reading = _open_osfhandle(std::intptr_t(read), _O_RDONLY | _O_BINARY);
  writing = _open_osfhandle(std::intptr_t(write), _O_WRONLY | _O_BINARY);
  return true;
}

/// A command that is no path may be that of a program in PATH; it may lack its ".exe".
int create(const std::vector<std::string>& argv, STARTUPINFOEXW& start, PROCESS_INFORMATION& made) {
  std::string line;
  for (const std::string& word : argv) line += (line.empty() ? "" : " ") + quoted(word);
  std::wstring words = wide(line);
  constexpr DWORD kHow = CREATE_NEW_PROCESS_GROUP | CREATE_SUSPENDED | EXTENDED_STARTUPINFO_PRESENT;
  if (CreateProcessW(nullptr, words.data(), nullptr, nullptr, TRUE, kHow, nullptr, nullptr, &start.StartupInfo, &made))
    return 0;
  return last_errno();
}

/// A job ends with its last handle: children do not survive this process.
HANDLE job_of(HANDLE process) {
  const HANDLE job = CreateJobObjectW(nullptr, nullptr);
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits{};
  limits.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE;
  SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits);
  AssignProcessToJobObject(job, process);
  return job;
}

}  // namespace

Process::~Process() { release(); }

int Process::start(const std::vector<std::string>& argv, const Descriptors& given) {
  HANDLE streams[] = {inheritable(given.in, GENERIC_READ), inheritable(given.out, GENERIC_WRITE),
                      inheritable(given.err, GENERIC_WRITE)};
  // Only these are inherited: another thread may start a process at the same time.
  SIZE_T bytes = 0;
  InitializeProcThreadAttributeList(nullptr, 1, 0, &bytes);
  std::vector<char> list(bytes);
  STARTUPINFOEXW start{};
  start.StartupInfo.cb = sizeof start;
  start.StartupInfo.dwFlags = STARTF_USESTDHANDLES;
  start.StartupInfo.hStdInput = streams[0];
  start.StartupInfo.hStdOutput = streams[1];
  start.StartupInfo.hStdError = streams[2];
  start.lpAttributeList = reinterpret_cast<LPPROC_THREAD_ATTRIBUTE_LIST>(list.data());
  InitializeProcThreadAttributeList(start.lpAttributeList, 1, 0, &bytes);
  UpdateProcThreadAttribute(start.lpAttributeList, 0, PROC_THREAD_ATTRIBUTE_HANDLE_LIST, streams, sizeof streams,
                            nullptr, nullptr);
  PROCESS_INFORMATION made{};
  const int failed = create(argv, start, made);
  DeleteProcThreadAttributeList(start.lpAttributeList);
  for (const HANDLE stream : streams) CloseHandle(stream);
  if (failed != 0) return failed;
  process_ = std::intptr_t(made.hProcess);
  group_ = std::intptr_t(job_of(made.hProcess));
  ResumeThread(made.hThread);
  CloseHandle(made.hThread);
  return 0;
}

Process::Status Process::poll() {
  const HANDLE process = HANDLE(process_);
  DWORD code = 0;
  if (WaitForSingleObject(process, 0) == WAIT_TIMEOUT) return {State::kRunning};
  if (!GetExitCodeProcess(process, &code)) {
    errno = last_errno();
    return {State::kLost};
  }
  // A crash ends with the number of its exception, such as 0xC0000005.
  return {code >= 0xC0000000u ? State::kSignalled : State::kExited, int(code)};
}

void Process::request_end() const {
  const DWORD id = GetProcessId(HANDLE(process_));
  const HANDLE stop = OpenEventW(EVENT_MODIFY_STATE, FALSE, stop_event_of(id).c_str());
  if (stop == nullptr) {  // not one of these programs
    GenerateConsoleCtrlEvent(CTRL_BREAK_EVENT, id);
    return;
  }
  SetEvent(stop);
  CloseHandle(stop);
}

void Process::kill() const { TerminateJobObject(HANDLE(group_), 9); }

void Process::release() {
  if (process_ == 0) return;
  CloseHandle(HANDLE(process_));
  CloseHandle(HANDLE(group_));
  process_ = group_ = 0;
}

bool open_channels(Channels& channels) {
  return open_pipe(channels.of_child_in, channels.to) && open_pipe(channels.from, channels.of_child_out);
}

std::int64_t send_some(int descriptor, const void* data, std::size_t bytes) {
  return _write(descriptor, data, unsigned(std::min<std::size_t>(bytes, 1 << 16)));
}

bool is_readable_within(int descriptor, int milliseconds) {
  constexpr int kPauseMs = 2;
  for (int waited = 0;; waited += kPauseMs) {
    DWORD bytes = 0;
    const bool open = PeekNamedPipe(HANDLE(_get_osfhandle(descriptor)), nullptr, 0, nullptr, &bytes, nullptr);
    if (!open || bytes > 0) return true;
    if (waited >= milliseconds) return false;
    Sleep(kPauseMs);
  }
}

std::int64_t read_some(int descriptor, void* to, std::size_t bytes) { return _read(descriptor, to, unsigned(bytes)); }

/// Windows cannot replace a process: this one waits, and both receive Ctrl-C.
int become(const std::vector<std::string>& argv) {
  std::string line;
  for (const std::string& word : argv) line += (line.empty() ? "" : " ") + quoted(word);
  std::wstring words = wide(line);
  STARTUPINFOW start{};
  start.cb = sizeof start;
  PROCESS_INFORMATION made{};
  if (!CreateProcessW(nullptr, words.data(), nullptr, nullptr, TRUE, 0, nullptr, nullptr, &start, &made))
    return last_errno();
  SetConsoleCtrlHandler(nullptr, TRUE);  // ignored here, so that the exit code is that of the program
  WaitForSingleObject(made.hProcess, INFINITE);
  DWORD code = 0;
  GetExitCodeProcess(made.hProcess, &code);
  std::exit(int(code));
}

}  // namespace ngs::os
