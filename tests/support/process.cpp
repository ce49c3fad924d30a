#include "support/process.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace ngs::test {
namespace {

constexpr double kLimitS = 300, kEmulatedLimitS = 3600;

struct Pipe {
  int read_end = -1, write_end = -1;
  explicit Pipe(bool is_terminal = false) { is_terminal ? open_terminal() : open_pipe(); }
  ~Pipe() {
    close_read();
    close_write();
  }
  void close_read() { read_end = read_end >= 0 ? (close(read_end), -1) : -1; }
  void close_write() { write_end = write_end >= 0 ? (close(write_end), -1) : -1; }

 private:
  void open_pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
    read_end = ends[0];
    write_end = ends[1];
  }
  void open_terminal() {
    read_end = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (read_end < 0 || grantpt(read_end) != 0 || unlockpt(read_end) != 0)
      throw std::runtime_error("posix_openpt failed");
    write_end = open(ptsname(read_end), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios mode{};
    if (write_end < 0 || tcgetattr(write_end, &mode) != 0) throw std::runtime_error("the terminal cannot be opened");
    cfmakeraw(&mode);
    tcsetattr(write_end, TCSANOW, &mode);
  }
};

[[noreturn]] void become(const ProcessSpec& spec, const Pipe& in, const Pipe& out, const Pipe& err) {
  dup2(in.read_end, STDIN_FILENO);
  dup2(out.write_end, STDOUT_FILENO);
  dup2(err.write_end, STDERR_FILENO);
  if (!spec.folder.empty() && chdir(spec.folder.c_str()) != 0) _exit(126);
  for (const auto& [name, value] : spec.environment) setenv(name.c_str(), value.c_str(), 1);
  std::vector<char*> argv;
  for (const std::string& word : spec.argv) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  _exit(127);
}

/// Appends the available bytes; false at the end of the stream.
bool drain(int descriptor, std::string& text) {
  char buffer[65536];
  const ssize_t count = read(descriptor, buffer, sizeof buffer);
  if (count > 0) text.append(buffer, std::size_t(count));
  return count > 0;
}

ProcessResult run_within(double limit_s, const ProcessSpec& spec) {
  using Clock = std::chrono::steady_clock;
  signal(SIGPIPE, SIG_IGN);  // a program that does not read its stdin must not end the test
  Pipe in, out, err(spec.err_is_terminal);
  // The child must not run the handlers of the test framework between fork and exec.
  sigset_t all, before;
  sigfillset(&all);
  sigprocmask(SIG_BLOCK, &all, &before);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    for (const int number : {SIGPIPE, SIGTERM, SIGINT, SIGUSR1, SIGHUP, SIGQUIT}) signal(number, SIG_DFL);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    if (spec.closed_stdout) close(out.read_end);
    become(spec, in, out, err);
  }
  sigprocmask(SIG_SETMASK, &before, nullptr);
  in.close_read();
  out.close_write();
  err.close_write();
  if (spec.closed_stdout) out.close_read();
  if (!spec.input.empty() && write(in.write_end, spec.input.data(), spec.input.size()) < 0) in.close_write();
  in.close_write();

  ProcessResult result;
  const Clock::time_point start = Clock::now();
  bool signal_sent = spec.signal == 0, out_open = !spec.closed_stdout, err_open = true;
  while (out_open || err_open) {
    pollfd streams[2] = {{out_open ? out.read_end : -1, POLLIN, 0}, {err_open ? err.read_end : -1, POLLIN, 0}};
    poll(streams, 2, signal_sent ? 100 : 1);
    if (streams[0].revents != 0) out_open = drain(out.read_end, result.out);
    if (streams[1].revents != 0) err_open = drain(err.read_end, result.err);
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
    const bool due = spec.signal_after_ms >= 0 ? elapsed_s * 1e3 >= spec.signal_after_ms
                                               : result.err.find(spec.signal_after) != std::string::npos;
    if (!signal_sent && due) {
      kill(child, spec.signal);
      signal_sent = true;
    }
    if (elapsed_s > limit_s && !result.timed_out) {
      kill(child, SIGKILL);
      result.timed_out = true;
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace

bool emulated() {
  static const bool is = [] {
    utsname own{};
    ProcessSpec spec;
    spec.argv = {"uname", "-m"};  // the host's uname
    const ProcessResult machine = run_within(kLimitS, spec);
    return uname(&own) == 0 && machine.exit_code == 0 && machine.out != std::string(own.machine) + "\n";
  }();
  return is;
}

bool under_wine() { return std::getenv("NGS_WINDOWS_TOOLS") != nullptr; }

ProcessResult run_process(const ProcessSpec& spec) {
  return run_within(emulated() || under_wine() ? kEmulatedLimitS : kLimitS, spec);
}

ProcessResult run_command(Words argv) { return run_process({.argv = std::move(argv)}); }

ProcessResult run_tool(Words argv, const std::string& folder, const Environment& more, const std::string& input) {
  argv[0] = NGS_TOOL_DIR "/" + argv[0];
  return run_process(
      {.argv = argv, .environment = joined({{"NGS_THREADS", "2"}}, more), .folder = folder, .input = input});
}

ProcessResult succeeded(ProcessResult result, CallSite where) {
  INFO(where.text() << "\n" << result.out << result.err);
  REQUIRE(result.exit_code == 0);
  return result;
}

ProcessResult refused(ProcessResult result, int exit_code, const std::string& text, CallSite where) {
  INFO(where.text() << "\n" << result.out << result.err);
  CHECK(result.exit_code == exit_code);
  CHECK(result.err.find(text) != std::string::npos);
  return result;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

Words split(const std::string& line) {
  std::istringstream text(line);
  return {std::istream_iterator<std::string>(text), {}};
}

}  // namespace ngs::test
