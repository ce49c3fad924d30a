#pragma once
// Runs a program without a shell: a command line is split into words once and placeholders are replaced within words,
// so that no file name can become a command.
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/os/process.h"

namespace ngs::cli {

/// Words of a command line: blanks separate, '...' and "..." group, a backslash quotes the next character (not within
/// '...'). Throws kUsage for an open quote, a trailing backslash and an empty line.
std::vector<std::string> split_command(const std::string& line);

/// Replaces every "{key}" in the words in one pass: text inside a value is not replaced again.
std::vector<std::string> fill_placeholders(std::vector<std::string> words,
                                           const std::map<std::string, std::string>& values);

struct ChildResult {
  enum class End { kExited, kSignalled, kTimedOut, kStopped } end = End::kExited;
  int code = 0;             // exit status or signal number
  std::string output_tail;  // the end of what it wrote on stderr and stdout, at most 2000 bytes, one line
                            // each, printable
};

struct ChildLimits {
  double time_s = 600;
  std::function<bool()> stop = {};  // polled; true: the child is terminated
  double grace_s = 2;               // from SIGTERM to SIGKILL
  double grace_on_stop_s = 0.2;     // the same on `stop`: shorter than the grace period after a signal
  std::function<void(const std::string& line)> on_line = {};  // called with each line of output while the child runs
};

/// Starts a program. Throws kEnvironment if it cannot be started.
void start_program(os::Process& process, const std::vector<std::string>& argv, const os::Descriptors& descriptors);

/// A new unnamed file in the temporary folder (os::unnamed_file). Throws kEnvironment.
int unnamed_file();
/// The end of such a file, as in ChildResult::output_tail.
std::string output_tail_of(int descriptor);

/// Runs the child with an empty stdin and collects stdout and stderr. The child has its own process group, which is
/// terminated (SIGTERM, then SIGKILL) at the time limit and on `stop`. Throws kEnvironment if it cannot be started.
ChildResult run_child(const std::vector<std::string>& argv, const ChildLimits& limits);

// The other tools: programs in the folder of this one, or on Windows parts of it.

/// The command that begins with a tool and its arguments, with the path of the program that runs it. Throws
/// kEnvironment if the program is missing or not executable.
std::vector<std::string> sibling_command(std::vector<std::string> words);

/// Quotes `words` as a command line that a shell splits into the same words.
std::string quoted_line(const std::vector<std::string>& words);

// A program that is started once and serves many requests, each a line on its stdin, answered by a line on its stdout.

class LineProgram {
 public:
  /// Throws kEnvironment if it cannot be started. It has its own process group, as in run_child().
  explicit LineProgram(const std::vector<std::string>& argv);
  /// Closes the program's stdin. If the program has not ended after 0.5 s, terminates its process group.
  ~LineProgram();
  LineProgram(const LineProgram&) = delete;
  LineProgram& operator=(const LineProgram&) = delete;

  struct Response {
    std::string line = {};             // without the newline
    std::optional<ChildResult> ended;  // set: the program has ended and sends no more responses
  };
  /// Sends `line` and returns the next line that begins with '{'. Other lines are ignored: libraries print them. At the
  /// time limit and on `stop` the program is terminated. Throws kBadInput for a line above 1 MiB.
  Response request(const std::string& line, const ChildLimits& limits);

 private:
  bool send(const std::string& text) const;
  std::optional<std::string> next_line();
  /// Waits `grace_s` for the program to end, then sends SIGTERM, and SIGKILL after another `grace_s`; with another
  /// reason than kExited, SIGTERM at once. The program must be running.
  ChildResult end(ChildResult::End why, double grace_s);

  std::string name_, received_;
  int stdin_fd_ = -1, stdout_fd_ = -1, stderr_fd_ = -1;  // stderr goes to a file
  ChildResult ended_;
  os::Process process_;  // not started: has ended
};

}  // namespace ngs::cli
