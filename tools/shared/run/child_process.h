#pragma once
// Runs a program, of the user or a sibling of this one, without a shell: a command line is split into words once,
// placeholders are filled in within words, so that no file name can become a command.
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace ngs::cli {

/// Words of a command line: blanks separate, '...' and "..." group, a backslash takes the next character as
/// it is (not within '...'). kUsage for an open quote, a trailing backslash and an empty line.
std::vector<std::string> split_command(const std::string& line);

/// Every "{key}" of the words replaced, in one pass: what a value holds is never replaced again.
std::vector<std::string> fill_placeholders(std::vector<std::string> words,
                                           const std::map<std::string, std::string>& values);

struct ChildResult {
  enum class End { kExited, kSignalled, kTimedOut, kStopped } end = End::kExited;
  int code = 0;            // exit status or signal number
  std::string last_words;  // the end of what it wrote on stderr and stdout, at most 2000 bytes, one line
                           // each, printable
};

struct ChildLimits {
  double time_s = 600;
  std::function<bool()> stop = {};                            // polled; true: the child is ended
  double patience_s = 2;                                      // from asking it to end (SIGTERM) to ending it (SIGKILL)
  double patience_on_stop_s = 0.2;                            // the same on `stop`: within what a signal leaves
  std::function<void(const std::string& line)> on_line = {};  // what it writes, line by line, while it runs
};

/// What a program is started with; -1: /dev/null.
struct Descriptors {
  int in = -1, out = -1, err = -1;
};
/// Its process id, which is that of its process group too. Signals have their defaults there. kEnvironment where it
/// cannot be started.
int spawn_program(const std::vector<std::string>& argv, const Descriptors& descriptors);

/// A new file without a name, which goes with its descriptor.
int unnamed_file();
/// The end of such a file, as ChildResult::last_words has it.
std::string last_words_in(int descriptor);

/// stdin is empty; stdout and stderr are kept. The child has a process group of its own, which is ended as a
/// whole (SIGTERM, then SIGKILL) at the time limit and on `stop`. kEnvironment where it cannot be
/// started.
ChildResult run_child(const std::vector<std::string>& argv, const ChildLimits& limits);

}  // namespace ngs::cli
