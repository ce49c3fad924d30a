#pragma once
// Runs a program as a shell would, and captures its output.
#include <string>
#include <utility>
#include <vector>

#include "support/call_site.h"

namespace ngs::test {

using Words = std::vector<std::string>;
using Environment = std::vector<std::pair<std::string, std::string>>;

/// How often a text contains a part.
std::size_t occurrences(const std::string& text, const std::string& part);

/// The words of a command line without quotes.
Words split(const std::string& line);

template <class T>
std::vector<T> joined(std::vector<T> first, const std::vector<T>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

struct ProcessSpec {
  Words argv;
  Environment environment = {};  // added to the test's environment
  std::string folder = {};       // working directory; empty: the test's
  std::string input = {};        // stdin
  int signal = 0;                // sent once stderr holds `signal_after`, or after `signal_after_ms`
  std::string signal_after = {};
  int signal_after_ms = -1;
  bool closed_stdout = false;    // stdout is a closed pipe
  bool err_is_terminal = false;  // stderr is a terminal in raw mode
};

struct ProcessResult {
  int exit_code = -1;  // 128 + signal number if a signal ended the process, as in a shell
  std::string out, err;
  bool timed_out = false;  // killed after 5 min (in an emulator, under Wine: 1 h)
};

/// Whether this program runs in an emulator of another processor (tests/ci/aarch64.sh). The tools then run in it too,
/// 10 to 30 times slower, but compilers, shells and interpreters started by a case do not.
bool emulated();

/// Whether the tools are those of Windows, run by Wine (ci/windows-archive.sh).
bool under_wine();

ProcessResult run_process(const ProcessSpec& spec);
/// The same for a command line only.
ProcessResult run_command(Words argv);
/// Runs a built tool on two threads; argv[0] is its name.
ProcessResult run_tool(Words argv, const std::string& folder = {}, const Environment& more = {},
                       const std::string& input = {});
/// The result of a program that must have ended with 0: the test case ends if it has not, and shows what it printed.
ProcessResult succeeded(ProcessResult result, CallSite where = CallSite::current());
/// Checks the exit code of a program and that stderr contains a text, and shows all that it printed if not.
ProcessResult refused(ProcessResult result, int exit_code, const std::string& text,
                      CallSite where = CallSite::current());

}  // namespace ngs::test
