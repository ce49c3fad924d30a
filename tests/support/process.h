#pragma once
// Runs a program the way a shell would and keeps what it says.
#include <string>
#include <utility>
#include <vector>

namespace ngs::test {

struct ProcessSpec {
  std::vector<std::string> argv;
  std::vector<std::pair<std::string, std::string>> environment;  // added to ours
  std::string folder;                                            // working directory; empty: ours
  std::string input;                                             // stdin
  int signal = 0;  // sent once stderr holds `signal_after`, or after `signal_after_ms`
  std::string signal_after;
  int signal_after_ms = -1;
  bool closed_stdout = false;    // nobody reads stdout
  bool err_is_terminal = false;  // stderr is a terminal that passes on what it is given, byte by byte
};

struct ProcessResult {
  int exit_code = -1;  // 128 + number where a signal ended it, as in a shell
  std::string out, err;
  bool timed_out = false;  // killed after 60 s, under an emulator after an hour
};

/// Whether an emulator of another processor runs this program (tests/ci/aarch64.sh). Then it runs the tools too, 10 to
/// 30 times slower, but not the compilers, shells and interpreters that a case starts.
bool emulated();

ProcessResult run_process(const ProcessSpec& spec);
/// The same of a command and nothing else.
ProcessResult run_command(std::vector<std::string> argv);

}  // namespace ngs::test
