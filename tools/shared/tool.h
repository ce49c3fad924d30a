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
// "-" is stdin or stdout (run/streams.h); the report then goes to --report only.
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

#include "ngs/options/option_set.h"
#include "shared/cli/arguments.h"
#include "shared/cli/exit_code.h"
#include "shared/run/run.h"

namespace ngs::cli {

class Tool {
 public:
  /// `examples`: at least one command line; the first two open the help text.
  Tool(std::string name, std::string summary, std::initializer_list<std::string> examples);
  ~Tool();
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  /// Any number of structs with describe(). Options given for a group that does not apply are warned about before the
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
  /// `also`: another flag that means the same.
  const Input& optional_input(std::string name, std::string help, std::string also = {});
  /// A word: at least one path behind the other positionals. A flag: any number, repeated or as a list with commas.
  const Inputs& inputs(std::string name, std::string help);
  const Argument& argument(std::string name, std::string help);
  const Output& output(std::string flags, std::string help);
  const Output& optional_output(std::string flags, std::string help);
  const Output& output_dir(std::string flags, std::string help);
  const Output& optional_output_dir(std::string flags, std::string help);
  /// Optional; may hold what an earlier run left, with and without -w. The tool makes it, and looks what is in it.
  const Output& resumed_output_dir(std::string flags, std::string help);
  /// Where this option is set the tool writes nothing, and asks for no output, as in a dry run.
  void writes_nothing_if(const bool& option);
  /// A part of --help, behind the options, and what --help NAME says; asked once the command line is read. Empty: not
  /// shown.
  void help(std::string name, std::function<std::string(bool in_full)> text);
  /// The body polls monitor().stop_requested(), and has 0.3 s to end after a signal, or as long as it takes
  /// while it keeps a state (run/signals.h). Otherwise a signal ends the tool at once, without output.
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

}  // namespace ngs::cli
