#pragma once
// A program that is started once and asked many times: a line on its stdin, the answer a line on its stdout.
#include <optional>
#include <string>
#include <vector>

#include "shared/run/child_process.h"

namespace ngs::cli {

class LineProgram {
 public:
  /// kEnvironment where it cannot be started. It has a process group of its own, as run_child() gives one.
  explicit LineProgram(const std::vector<std::string>& argv);
  /// Closes its stdin, which ends it; after half a second the group is ended.
  ~LineProgram();
  LineProgram(const LineProgram&) = delete;
  LineProgram& operator=(const LineProgram&) = delete;

  struct Answer {
    std::string line;                  // without its line feed
    std::optional<ChildResult> ended;  // set: there is no line, nor any further answer
  };
  /// The first line of what follows that begins with '{'; others are what libraries print. At the time limit and on
  /// `stop` the program is ended. kBadInput for a line of more than a mebibyte.
  Answer ask(const std::string& line, const ChildLimits& limits);

 private:
  bool send(const std::string& text) const;
  std::optional<std::string> next_line();
  /// Of a program that runs.
  ChildResult end(ChildResult::End why, double patience_s);

  std::string name_, received_;
  int to_ = -1, from_ = -1, said_ = -1;  // its stdin, its stdout, a file with its stderr
  ChildResult ended_;
  int process_ = 0;  // 0: has ended
};

}  // namespace ngs::cli
