#pragma once
// A program that is started once and serves many requests: each request is a line on its stdin, each response a
// line on its stdout.
#include <optional>
#include <string>
#include <vector>

#include "shared/run/child_process.h"

namespace ngs::cli {

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
