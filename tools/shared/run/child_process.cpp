#include "shared/run/child_process.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/os/output_file.h"
#include "shared/os/files.h"
#include "shared/os/machine.h"

namespace ngs::cli {
namespace {

constexpr std::size_t kLastWords = 2000;

/// An unnamed file for the output of the child; a pipe would have to be read while the child runs.
struct Transcript {
  int descriptor = -1;
  std::int64_t position = 0;  // read so far
  std::string line;           // the last line, as far as it was read
  Transcript() { descriptor = unnamed_file(); }
  ~Transcript() { os::close_file(descriptor); }
  Transcript(const Transcript&) = delete;

  /// Calls `on_line` for every line completed since the last call.
  void read_on(const std::function<void(const std::string&)>& on_line) {
    char block[4096];
    for (std::int64_t count; (count = os::read_at(descriptor, block, sizeof block, position)) > 0;) {
      position += count;
      for (const char c : std::string_view(block, std::size_t(count))) {
        if (c != '\n') {
          line += c;
          continue;
        }
        on_line(std::exchange(line, {}));
      }
    }
  }
};

constexpr std::size_t kMaxLineBytes = 1 << 20;
constexpr double kGraceAtEnd_s = 0.5;
constexpr int kPollMs = 20;

void close_descriptor(int& descriptor) {
  if (descriptor >= 0) os::close_file(descriptor);
  descriptor = -1;
}

}  // namespace

int unnamed_file() {
  const std::string name = os::temporary_path("ngs-child-XXXXXX");
  const int descriptor = os::unnamed_file(name);
  if (descriptor < 0) throw Error(ErrorCode::kEnvironment, name + ": cannot be created: " + std::strerror(errno));
  return descriptor;
}

std::string output_tail_of(int descriptor) {
  const std::int64_t size = std::max<std::int64_t>(0, os::size_of_file(descriptor));
  std::string text(std::min(std::size_t(size), kLastWords), '\0');
  const std::int64_t count = os::read_at(descriptor, text.data(), text.size(), size - std::int64_t(text.size()));
  text.resize(count > 0 ? std::size_t(count) : 0);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  for (char& c : text)
    if (c != '\n' && (static_cast<unsigned char>(c) < 32 || c == 127)) c = '?';
  return text;
}

void start_program(os::Process& process, const std::vector<std::string>& argv, const os::Descriptors& descriptors) {
  if (const int reason = process.start(argv, descriptors); reason != 0)
    throw Error(ErrorCode::kEnvironment, argv[0] + ": cannot be started: " + std::strerror(reason),
                "name a program that is in PATH, or give its full path");
}

std::vector<std::string> split_command(const std::string& line) {
  std::vector<std::string> words;
  bool open = false;
  char quote = 0;
  const auto word = [&]() -> std::string& {
    if (!open) {
      words.emplace_back();
      open = true;
    }
    return words.back();
  };
  const auto refuse = [&](const char* found) {
    throw Error(ErrorCode::kUsage, "the command '" + line + "': " + found + ", expected words as in a shell");
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '\\' && quote != '\'') {
      if (++i == line.size()) refuse("it ends in a backslash");
      word() += line[i];
    } else if (quote != 0) {
      if (c == quote)
        quote = 0;
      else
        word() += c;
    } else if (c == '\'' || c == '"') {
      quote = c;
      word();
    } else if (c == ' ' || c == '\t' || c == '\n') {
      open = false;
    } else {
      word() += c;
    }
  }
  if (quote != 0) refuse("a quote is not closed");
  if (words.empty()) refuse("it is empty");
  return words;
}

std::vector<std::string> fill_placeholders(std::vector<std::string> words,
                                           const std::map<std::string, std::string>& values) {
  for (std::string& word : words) {
    std::string filled;
    for (std::size_t i = 0; i < word.size();) {
      const std::size_t close = word[i] == '{' ? word.find('}', i) : std::string::npos;
      const auto value = close == std::string::npos ? values.end() : values.find(word.substr(i + 1, close - i - 1));
      if (value == values.end())
        filled += word[i++];
      else {
        filled += value->second;
        i = close + 1;
      }
    }
    word = std::move(filled);
  }
  return words;
}

ChildResult run_child(const std::vector<std::string>& argv, const ChildLimits& limits) {
  NGS_CHECK(!argv.empty(), "a program to run");
  Transcript transcript;
  os::Process child;
  start_program(child, argv, {.in = -1, .out = transcript.descriptor, .err = transcript.descriptor});
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const Clock::time_point start = Clock::now();
  Clock::time_point asked{};
  ChildResult::End why = ChildResult::End::kExited;
  os::Process::Status status{};
  for (double pause_ms = 1; (status = child.poll()).state == os::Process::State::kRunning;
       pause_ms = std::min(50.0, pause_ms * 1.5)) {
    const bool late = since(start) > limits.time_s, stopped = limits.stop && limits.stop();
    if (why == ChildResult::End::kExited && (late || stopped)) {
      asked = Clock::now();
      why = stopped ? ChildResult::End::kStopped : ChildResult::End::kTimedOut;
      child.request_end();
    } else if (why != ChildResult::End::kExited && since(asked) > (stopped ? limits.grace_on_stop_s : limits.grace_s)) {
      child.kill();
    }
    if (limits.on_line) transcript.read_on(limits.on_line);
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(pause_ms));
  }
  if (limits.on_line) transcript.read_on(limits.on_line);
  const bool ended_by_itself = why == ChildResult::End::kExited;
  if (!ended_by_itself) child.kill();  // processes that the child started
  if (status.state == os::Process::State::kLost && ended_by_itself)
    throw Error(ErrorCode::kEnvironment, argv[0] + ": its exit code is lost: " + std::strerror(errno),
                "start this process with the default SIGCHLD handler: if SIGCHLD is ignored, exit codes are lost");
  if (ended_by_itself && status.state == os::Process::State::kSignalled) why = ChildResult::End::kSignalled;
  return {why, status.code, output_tail_of(transcript.descriptor)};
}

namespace fs = std::filesystem;

std::vector<std::string> sibling_command(std::vector<std::string> words) {
  const fs::path self = os::path_of_this_program();
  const int unknown = self.empty() ? errno : 0;
  const std::string program = words[0];
  words[0] = (self.parent_path() / program).generic_string() + (self.extension() == ".exe" ? ".exe" : "");
  if (unknown != 0 || !os::is_executable(words[0]))
    throw Error(ErrorCode::kEnvironment,
                words[0] + ": " + std::strerror(unknown != 0 ? unknown : errno) + ", expected the program " + program +
                    " next to " + self.filename().string(),
                "install all tools into one folder");
  return words;
}

std::string quoted_line(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + io::shell_word(word);
  return text;
}

LineProgram::LineProgram(const std::vector<std::string>& argv) : name_(argv[0]) {
  os::Channels ends;
  const bool is_open = os::open_channels(ends);
  const int reason = errno;
  stdin_fd_ = ends.to;
  stdout_fd_ = ends.from;
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
  close_descriptor(ends.of_child_in);
  close_descriptor(ends.of_child_out);
}

LineProgram::~LineProgram() {
  close_descriptor(stdin_fd_);
  if (process_.is_started()) end(ChildResult::End::kExited, kGraceAtEnd_s);
  close_descriptor(stdout_fd_);
  close_descriptor(stderr_fd_);
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
      is_requested = true;
      since_s = wall_seconds();
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
