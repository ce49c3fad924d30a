#include "shared/run/line_program.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/os/output_file.h"

namespace ngs::cli {
namespace {

constexpr std::size_t kMaxLineBytes = 1 << 20;
constexpr double kGraceAtEnd_s = 0.5;
constexpr int kPollMs = 20;

void close_descriptor(int& descriptor) {
  if (descriptor >= 0) os::close_file(descriptor);
  descriptor = -1;
}

}  // namespace

LineProgram::LineProgram(const std::vector<std::string>& argv) : name_(argv[0]) {
  os::Channels ends;
  const bool is_open = os::open_channels(ends);
  const int reason = errno;
  stdin_fd_ = ends.to, stdout_fd_ = ends.from;
  try {
    if (!is_open)
      throw Error(ErrorCode::kEnvironment, name_ + ": no connection to the program: " + std::strerror(reason));
    stderr_fd_ = unnamed_file();
    start_program(process_, argv, {.in = ends.of_child_in, .out = ends.of_child_out, .err = stderr_fd_});
  } catch (...) {
    for (int* descriptor : {&ends.of_child_in, &ends.of_child_out, &stdin_fd_, &stdout_fd_, &stderr_fd_})
      close_descriptor(*descriptor);
    throw;
  }
  close_descriptor(ends.of_child_in), close_descriptor(ends.of_child_out);
}

LineProgram::~LineProgram() {
  close_descriptor(stdin_fd_);
  if (process_.is_started()) end(ChildResult::End::kExited, kGraceAtEnd_s);
  close_descriptor(stdout_fd_), close_descriptor(stderr_fd_);
}

bool LineProgram::send(const std::string& text) const {
  for (std::size_t done = 0; done < text.size();) {
    const std::int64_t count = os::send_some(stdin_fd_, text.data() + done, text.size() - done);
    if (count < 0) return false;
    done += std::size_t(count);
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

/// Requests it to end, or with kExited first waits `grace_s`, then requests it; after another `grace_s` kills it.
ChildResult LineProgram::end(ChildResult::End why, double grace_s) {
  ChildResult result;
  result.end = why;
  double since_s = wall_seconds();
  bool is_requested = why != ChildResult::End::kExited;
  if (is_requested) process_.request_end();
  os::Process::Status status{};
  while ((status = process_.poll()).state == os::Process::State::kRunning) {
    if (wall_seconds() - since_s > grace_s) {
      is_requested ? process_.kill() : process_.request_end();
      is_requested = true, since_s = wall_seconds();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  process_.kill();  // processes that it started
  process_.release();
  if (why == ChildResult::End::kExited && status.state == os::Process::State::kSignalled)
    result.end = ChildResult::End::kSignalled;
  result.code = status.code;
  result.output_tail = output_tail_of(stderr_fd_);
  return ended_ = result;
}

LineProgram::Response LineProgram::request(const std::string& line, const ChildLimits& limits) {
  using End = ChildResult::End;
  const double start_s = wall_seconds();
  if (!process_.is_started()) return {.ended = ended_};
  if (!send(line + "\n")) return {.ended = end(End::kExited, limits.grace_s)};
  while (true) {
    while (std::optional<std::string> found = next_line())
      if (found->starts_with("{")) return {.line = std::move(*found), .ended = std::nullopt};
    if (limits.stop && limits.stop()) return {.ended = end(End::kStopped, limits.grace_on_stop_s)};
    if (wall_seconds() - start_s > limits.time_s) return {.ended = end(End::kTimedOut, limits.grace_s)};
    if (!os::is_readable_within(stdout_fd_, kPollMs)) continue;
    char block[4096];
    const std::int64_t count = os::read_some(stdout_fd_, block, sizeof block);
    if (count == 0) return {.ended = end(End::kExited, limits.grace_s)};
    if (count > 0) received_.append(block, std::size_t(count));
  }
}

}  // namespace ngs::cli
