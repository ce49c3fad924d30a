#include "shared/run/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>

#include "ngs/core/check.h"
#include "ngs/core/error.h"

extern char** environ;

namespace ngs::cli {
namespace {

constexpr std::size_t kLastWords = 2000;

/// An unnamed file for the output of the child; a pipe would have to be read while the child runs.
struct Transcript {
  int descriptor = -1;
  off_t position = 0;  // read so far
  std::string line;    // the last line, as far as it was read
  Transcript() { descriptor = unnamed_file(); }
  ~Transcript() { close(descriptor); }
  Transcript(const Transcript&) = delete;

  /// Calls `on_line` for every line completed since the last call.
  void read_on(const std::function<void(const std::string&)>& on_line) {
    char block[4096];
    for (ssize_t count; (count = pread(descriptor, block, sizeof block, position)) > 0;) {
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

}  // namespace

int unnamed_file() {
  std::string name = (std::filesystem::temp_directory_path() / "ngs-child-XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) throw Error(ErrorCode::kEnvironment, name + ": cannot be created: " + std::strerror(errno));
  unlink(name.c_str());
  return descriptor;
}

std::string output_tail_of(int descriptor) {
  const off_t size = lseek(descriptor, 0, SEEK_END), from = size > off_t(kLastWords) ? size - off_t(kLastWords) : 0;
  std::string text(std::size_t(std::max(off_t(0), size - from)), '\0');
  const ssize_t count = pread(descriptor, text.data(), text.size(), from);
  text.resize(count > 0 ? std::size_t(count) : 0);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  for (char& c : text)
    if (c != '\n' && (static_cast<unsigned char>(c) < 32 || c == 127)) c = '?';
  return text;
}

int spawn_program(const std::vector<std::string>& argv, const Descriptors& given) {
  std::vector<char*> words;
  for (const std::string& word : argv) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (given.in < 0)
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  else
    posix_spawn_file_actions_adddup2(&files, given.in, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, given.out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, given.err, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, defaults;
  sigemptyset(&none), sigemptyset(&defaults);
  for (const int number : {SIGTERM, SIGINT, SIGUSR1, SIGPIPE, SIGXFSZ, SIGCHLD}) sigaddset(&defaults, number);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, short(POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF));
  pid_t child = 0;
  const int status = posix_spawnp(&child, words[0], &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (status != 0)
    throw Error(ErrorCode::kEnvironment, argv[0] + ": cannot be started: " + std::strerror(status),
                "name a program that is in PATH, or give its full path");
  return child;
}

std::vector<std::string> split_command(const std::string& line) {
  std::vector<std::string> words;
  bool open = false;
  char quote = 0;
  const auto word = [&]() -> std::string& {
    if (!open) words.emplace_back(), open = true;
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
      quote = c, word();
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
      else
        filled += value->second, i = close + 1;
    }
    word = std::move(filled);
  }
  return words;
}

ChildResult run_child(const std::vector<std::string>& argv, const ChildLimits& limits) {
  NGS_CHECK(!argv.empty(), "a program to run");
  Transcript transcript;
  const pid_t child = spawn_program(argv, {.out = transcript.descriptor, .err = transcript.descriptor});
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const Clock::time_point start = Clock::now();
  Clock::time_point asked{};
  ChildResult result;
  bool ending = false;
  int status = 0;
  pid_t ended = 0;
  for (double pause_ms = 1; (ended = waitpid(child, &status, WNOHANG)) == 0 || (ended < 0 && errno == EINTR);
       pause_ms = std::min(50.0, pause_ms * 1.5)) {
    const bool late = since(start) > limits.time_s, stopped = limits.stop && limits.stop();
    if (!ending && (late || stopped)) {
      ending = true, asked = Clock::now();
      result.end = stopped ? ChildResult::End::kStopped : ChildResult::End::kTimedOut;
      kill(-child, SIGTERM);
    } else if (ending && since(asked) > (stopped ? limits.grace_on_stop_s : limits.grace_s)) {
      kill(-child, SIGKILL);
    }
    if (limits.on_line) transcript.read_on(limits.on_line);
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(pause_ms));
  }
  if (limits.on_line) transcript.read_on(limits.on_line);
  if (ending) kill(-child, SIGKILL);  // processes that the child started
  if (ended < 0 && !ending)
    throw Error(ErrorCode::kEnvironment, argv[0] + ": its exit code is lost: " + std::strerror(errno),
                "start this process with the default SIGCHLD handler: if SIGCHLD is ignored, exit codes are lost");
  if (!ending && WIFSIGNALED(status)) result.end = ChildResult::End::kSignalled;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
  result.output_tail = output_tail_of(transcript.descriptor);
  return result;
}

}  // namespace ngs::cli
