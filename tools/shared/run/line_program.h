#pragma once
// A program that is started once and serves many requests: each request is a line on its stdin, each answer a line on
// its stdout.
#include <optional>
#include <string>
#include <vector>

#include "shared/run/child_process.h"

namespace ngs::cli {

class LineProgram {
 public:
  /// Throws kEnvironment if it cannot be started. It has its own process group, as in run_child().
  explicit LineProgram(const std::vector<std::string>& argv);
  /// Closes its stdin, which should end it; after 0.5 s terminates the process group.
  ~LineProgram();
  LineProgram(const LineProgram&) = delete;
  LineProgram& operator=(const LineProgram&) = delete;

  struct Answer {
    std::string line;                  // without the newline
    std::optional<ChildResult> ended;  // set: the program has ended and gives no more answers
  };
  /// Sends `line` and returns the next line that begins with '{'. Other lines are ignored: libraries print them. At the
  /// time limit and on `stop` the program is terminated. Throws kBadInput for a line above 1 MiB.
  Answer ask(const std::string& line, const ChildLimits& limits);

 private:
  bool send(const std::string& text) const;
  std::optional<std::string> next_line();
  /// Requires that the program runs.
  ChildResult end(ChildResult::End why, double patience_s);

  std::string name_, received_;
  int to_ = -1, from_ = -1, err_file_ = -1;  // its stdin, its stdout, a file with its stderr
  ChildResult ended_;
  os::Process process_;  // not started: has ended
};

}  // namespace ngs::cli
