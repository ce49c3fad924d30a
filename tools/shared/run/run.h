#pragma once
// The interface between the body of a tool and its run: execution settings, report, messages and progress.
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/core/monitor.h"
#include "ngs/options/option_set.h"
#include "shared/cli/arguments.h"
#include "shared/cli/common_flags.h"

namespace ngs::cli {

struct ChainProgress;
struct RunState;

class Run {
 public:
  explicit Run(RunState& state) : state_(state) {}

  const Exec& exec() const;
  /// Makes the device use atomic adds from now on (--fast-atomics) and reports it. Throws kUsage if it is the CPU.
  void sum_atomically();
  /// The body has no device path for its options: throws kEnvironment with --device cuda; with auto exec() is the CPU.
  void needs_cpu(const std::string& why);
  /// Call it once the model's size is known: with --device auto, exec() is the CPU if the device has less free memory.
  void needs_device_memory(double bytes);
  /// Returns part(). If the device's memory does not suffice for it, and --device auto chose the device, the part alone
  /// runs again with exec() on the CPU, where the run stays. For a body that should not start again as a whole.
  template <class Part>
  auto on_device_or_cpu(const Part& part) {
    try {
      return part();
    } catch (const OutOfDeviceMemory& e) {
      leave_device(e);
    }
    return part();
  }
  /// --device as given.
  DeviceChoice device_choice() const;
  /// True: the body runs again on the CPU, because the device's memory did not suffice.
  bool is_restart() const;
  Monitor& monitor();
  std::uint64_t seed() const;
  bool dry_run() const;  // read headers, call plan(), return 0
  bool allow_empty() const;
  bool overwrite() const;
  bool goes_to_stdout(const Output& output) const;
  bool comes_from_stream(const std::string& path) const;  // the input is stdin or a pipe: do not show its path
  bool comes_from_stream(const Input& input) const { return comes_from_stream(input.path); }

  /// "result" of the report. Integers at its top level are repeated in "counts".
  Json& result();
  /// "plan" of the report: the estimates of a dry run (memory, time, sizes).
  void plan(Json plan);
  /// For a tool that runs other tools: shows the progress of the whole run.
  void progress(const ChainProgress& chain);
  /// Prints a line on stderr with -v.
  void info(const std::string& message);
  /// Columns of the terminal on stderr; 0: stderr is no terminal.
  int columns() const;
  /// Prints a table on stderr unless -q.
  void text(const std::string& lines);
  /// The same, also with -q: without these lines the run is of no use.
  void needed(const std::string& lines);
  /// Like text(), but never wrapped, so that a command or JSON can be copied from the terminal.
  void verbatim(const std::string& lines);
  /// Adds a file that is read because an input names it to the report. Call it before writing anything: throws kUsage
  /// if the file is also an output, which would replace it.
  void add_input(const std::string& name, const std::string& path);
  /// Call it if there is nothing to work on: throws kNothingFound, or warns with --allow-empty.
  void nothing_found(const std::string& message, const std::string& remedy = {});

  /// Warns about options that were given for an effect (Field::of) for which `is_on` is false.
  void warn_unused(const std::function<bool(std::string_view effect)>& is_on);
  /// Warns about the given ones of `flags`, as "--points, --steps: not used without --model". `why` follows "not used".
  void warn_unused(const std::vector<std::string>& flags, const std::string& why);

  /// 130 or 143 after a signal, else 0. For bodies that poll monitor().stop_requested(): `return run.stop_code();`.
  int stop_code() const;

 private:
  void leave_device(const OutOfDeviceMemory& e);
  RunState& state_;
};

}  // namespace ngs::cli
