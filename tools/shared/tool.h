#pragma once
// What makes the binaries of ngs one program: declare options, inputs and outputs, then run() parses the command
// line, checks paths, hashes the inputs, runs the body, writes the report and maps errors to exit codes.
//
//   Tool tool("ngs-rbf", "Interpolate ...", {"ngs-rbf boundary.ply queries.ply -o field.ply"});
//   RbfOptions options;                      // a struct with describe() (options/field.h)
//   tool.options(options);
//   const Input& boundary = tool.input("boundary", "PLY written by ngs-variance");
//   const Output& out = tool.output("-o,--output", "query PLY");
//   return tool.run(argc, argv, [&](Run& run) { ...; return 0; });
//
// Positional inputs come in the order of their declaration; a name that begins with '-' declares a flag. The
// references stay valid for the tool's life and hold paths once the body runs. Before it runs: every given
// input exists, no output exists (unless -w), none is also an input, no two are one file, and the folders of the
// outputs exist.
// A dry run asks for no output.
// "-" is stdin or stdout (streams.h); the report then goes to --report only.
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/core/monitor.h"
#include "ngs/options/option_set.h"
#include "shared/exit_code.h"

namespace ngs::cli {

struct Input {
  std::string name, help;  // name: a word (positional) or a flag such as "--field"
  bool required = true;
  std::string path;  // empty: not given
  explicit operator bool() const { return !path.empty(); }
};

struct Inputs {  // one or more positional paths, behind the other positionals
  std::string name, help;
  std::vector<std::string> paths;
};

struct Output {
  std::string flags, help;  // "-o,--output"
  bool required = true;
  bool directory = false;  // made by the tool; must be absent or empty unless -w, which says what stays of before
  std::string path;        // empty: not given
  explicit operator bool() const { return !path.empty(); }
};

struct Argument {  // a positional word that is not a path
  std::string name, help, value;
};

struct RunState;

/// What the body of a tool is given.
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
  bool comes_from_stream(const Input& input) const;  // stdin or a pipe: its path names nothing

  /// "result" of the report. Whole numbers at its top level are also its "counts".
  Json& result();
  /// "plan" of the report: what a dry run has to say (estimated memory and time, sizes).
  void plan(Json plan);
  /// A line on stderr with -v.
  void info(const std::string& message);
  /// A table for people, on stderr unless -q.
  void text(const std::string& lines);
  /// A further file that is read (found through an input), for the report. To be called before anything is written:
  /// kUsage where it is an output too, which would replace it.
  void add_input(const std::string& name, const std::string& path);
  /// Nothing to work on: Error(kNothingFound), or with --allow-empty a warning.
  void nothing_found(const std::string& message, const std::string& remedy = {});
  /// Warns of the options that were given for effects (Field::of) of which `is_on` says that they are off.
  void warn_unused(const std::function<bool(std::string_view effect)>& is_on);
  /// 130 or 143 if a signal asked the tool to stop, else 0. For bodies that poll monitor().stop_requested():
  /// checkpoint, then `return run.stop_code();`.
  int stop_code() const;

 private:
  RunState& state_;
};

class Tool {
 public:
  /// `examples`: at least one command line; the first two open the help text.
  Tool(std::string name, std::string summary, std::initializer_list<std::string> examples);
  ~Tool();
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  /// Any number of structs with describe(). What is given of a group that nothing listens to is warned about before the
  /// body runs.
  template <class Options>
  void options(Options& options, OptionGroup group = {}) {
    option_set().add(options, std::move(group));
  }
  /// `prefix` goes before their option names ("fit_" -> --fit-steps).
  template <class Options>
  void options(Options& options, std::string_view prefix) {
    option_set().add(options, prefix);
  }
  /// For what adds groups of its own.
  OptionSet& option_set();
  const Input& input(std::string name, std::string help);
  const Input& optional_input(std::string name, std::string help);
  const Inputs& inputs(std::string name, std::string help);
  const Argument& argument(std::string name, std::string help);
  const Output& output(std::string flags, std::string help);
  const Output& optional_output(std::string flags, std::string help);
  const Output& output_dir(std::string flags, std::string help);
  const Output& optional_output_dir(std::string flags, std::string help);
  /// Where this option is set the tool writes nothing, and asks for no output, as in a dry run.
  void writes_nothing_if(const bool& option);
  /// A paragraph of --help behind the options.
  void help(std::string text);
  /// The body polls monitor().stop_requested(). Otherwise a signal ends the tool at once, without output.
  void stops_on_request();
  /// Every stage of the body runs through ops that have a device path. Otherwise --device cuda is refused.
  void runs_on_device();
  /// Parts of the body do, and are given Run::device_exec(); Run::exec() stays on the CPU.
  void runs_partly_on_device();

  /// Returns the exit code. The body returns kDone, kCheckFailed, kBudgetHit or run.stop_code().
  int run(int argc, char** argv, const std::function<int(Run&)>& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Sub-commands: "ngs-scene import ..." runs the entry "import" with argv moved by one. An entry with an
/// empty name runs where argv[1] is none of the others. Each entry makes its own Tool named "ngs-scene
/// import".
struct Command {
  std::string name;
  std::function<int(int, char**)> run;
  std::string summary = {};
};
int dispatch(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace ngs::cli
