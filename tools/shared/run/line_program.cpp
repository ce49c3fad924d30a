#include "shared/run/line_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"

namespace ngs::cli {
namespace {

constexpr std::size_t kMaxLineBytes = 1 << 20;
constexpr double kGraceAtEnd_s = 0.5;
constexpr int kPollMs = 20;

void close_descriptor(int& descriptor) {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

}  // namespace

LineProgram::LineProgram(const std::vector<std::string>& argv) : name_(argv[0]) {
  // A socket, because writing to a pipe without a reader would end this process by SIGPIPE.
  int socket[2], pipe[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, socket) != 0 || pipe2(pipe, O_CLOEXEC) != 0)
    throw Error(ErrorCode::kEnvironment, name_ + ": no connection to the program: " + std::strerror(errno));
  stdin_fd_ = socket[0], stdout_fd_ = pipe[0];
  try {
    stderr_fd_ = unnamed_file();
    process_ = spawn_program(argv, {.in = socket[1], .out = pipe[1], .err = stderr_fd_});
  } catch (...) {
    for (int* descriptor : {&socket[1], &pipe[1], &stdin_fd_, &stdout_fd_, &stderr_fd_}) close_descriptor(*descriptor);
    throw;
  }
  close(socket[1]), close(pipe[1]);
}

LineProgram::~LineProgram() {
  close_descriptor(stdin_fd_);
  if (process_ != 0) end(ChildResult::End::kExited, kGraceAtEnd_s);
  close_descriptor(stdout_fd_), close_descriptor(stderr_fd_);
}

bool LineProgram::send(const std::string& text) const {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::send(stdin_fd_, text.data() + done, text.size() - done, MSG_NOSIGNAL);
    if (count < 0 && errno != EINTR) return false;
    done += count > 0 ? std::size_t(count) : 0;
  }
  return true;
}

/// The next received line; nullopt: the line is not complete yet.
std::optional<std::string> LineProgram::next_line() {
  const std::size_t feed = received_.find('\n');
  if (feed == std::string::npos) {
    if (received_.size() > kMaxLineBytes)
      throw Error(ErrorCode::kBadInput, name_ + ": a line of more than 1 MiB, expected a response of one line");
    return std::nullopt;
  }
  std::string line = received_.substr(0, feed);
  received_.erase(0, feed + 1);
  return line;
}

ChildResult LineProgram::end(ChildResult::End why, double grace_s) {
  ChildResult result;
  result.end = why;
  double since_s = wall_seconds();
  int status = 0, next_signal = why == ChildResult::End::kExited ? 0 : SIGTERM;
  if (next_signal != 0) kill(-process_, next_signal);
  pid_t ended = 0;
  while ((ended = waitpid(process_, &status, WNOHANG)) == 0 || (ended < 0 && errno == EINTR)) {
    if (wall_seconds() - since_s > grace_s) {
      next_signal = next_signal == 0 ? SIGTERM : SIGKILL, since_s = wall_seconds();
      kill(-process_, next_signal);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(-process_, SIGKILL);  // processes that it started
  process_ = 0;
  if (why == ChildResult::End::kExited && WIFSIGNALED(status)) result.end = ChildResult::End::kSignalled;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
  result.output_tail = output_tail_of(stderr_fd_);
  return ended_ = result;
}

LineProgram::Response LineProgram::request(const std::string& line, const ChildLimits& limits) {
  using End = ChildResult::End;
  const double start_s = wall_seconds();
  if (process_ == 0) return {.line = {}, .ended = ended_};
  if (!send(line + "\n")) return {.line = {}, .ended = end(End::kExited, limits.grace_s)};
  while (true) {
    while (std::optional<std::string> found = next_line())
      if (found->starts_with("{")) return {.line = std::move(*found), .ended = std::nullopt};
    if (limits.stop && limits.stop()) return {.line = {}, .ended = end(End::kStopped, limits.grace_on_stop_s)};
    if (wall_seconds() - start_s > limits.time_s) return {.line = {}, .ended = end(End::kTimedOut, limits.grace_s)};
    pollfd readable{.fd = stdout_fd_, .events = POLLIN, .revents = 0};
    if (poll(&readable, 1, kPollMs) <= 0) continue;
    char block[4096];
    const ssize_t count = read(stdout_fd_, block, sizeof block);
    if (count == 0) return {.line = {}, .ended = end(End::kExited, limits.grace_s)};
    if (count > 0) received_.append(block, std::size_t(count));
  }
}

}  // namespace ngs::cli
