#pragma once
// What the body of a tool is given: where to compute, what to report and whom to tell.
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/core/monitor.h"
#include "ngs/options/option_set.h"
#include "shared/cli/arguments.h"

namespace ngs::cli {

struct RunState;

class Run {
 public:
  explicit Run(RunState& state) : state_(state) {}

  const Exec& exec() const;
  const Exec& device_exec() const;  // as --device says, for the parts of a tool that runs_partly_on_device()
  /// From now on device_exec() sums atomically (--fast-atomics), and the report says so. kUsage where it is the CPU.
  void sum_atomically();
  Monitor& monitor();
  std::uint64_t seed() const;
  bool dry_run() const;  // read headers, say plan(), return 0
  bool allow_empty() const;
  bool overwrite() const;
  bool goes_to_stdout(const Output& output) const;
  bool comes_from_stream(const std::string& path) const;  // of an input: stdin or a pipe, its path names nothing
  bool comes_from_stream(const Input& input) const { return comes_from_stream(input.path); }

  /// "result" of the report. Whole numbers at its top level are also its "counts".
  Json& result();
  /// "plan" of the report: what a dry run has to say (estimated memory and time, sizes).
  void plan(Json plan);
  /// For a tool that runs others: the progress that follows is that of stage `index` (from 1) of `count`.
  void stage_of_chain(std::size_t index, std::size_t count);
  /// A line on stderr with -v.
  void info(const std::string& message);
  /// Of the terminal that people read on; 0: it is none.
  int columns() const;
  /// A table for people, on stderr unless -q.
  void text(const std::string& lines);
  /// A further file that is read (found through an input), for the report. To be called before anything is written:
  /// kUsage where it is an output too, which would replace it.
  void add_input(const std::string& name, const std::string& path);
  /// Nothing to work on: Error(kNothingFound), or with --allow-empty a warning.
  void nothing_found(const std::string& message, const std::string& remedy = {});

  /// Warns of the options that were given for effects (Field::of) of which `is_on` says that they are off.
  void warn_unused(const std::function<bool(std::string_view effect)>& is_on);
  /// "--points, --steps: not used without --model", of those of these flags, of options and of files, that were given.
  /// `why` is what follows "not used".
  void warn_unused(const std::vector<std::string>& flags, const std::string& why);

  /// 130 or 143 if a signal asked the tool to stop, else 0. For bodies that poll monitor().stop_requested():
  /// checkpoint, then `return run.stop_code();`.
  int stop_code() const;

 private:
  RunState& state_;
};

}  // namespace ngs::cli
