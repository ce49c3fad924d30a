#pragma once
// The frame of every tool. Declare options, inputs and outputs; run() then parses the command line, checks paths,
// hashes the inputs, runs the body, writes the report and maps errors to exit codes.
//
//   Tool tool("ngs-rbf", "Interpolate ...", {"ngs-rbf boundary.ply queries.ply -o field.ply"});
//   RbfOptions options;                      // a struct with describe() (options/field.h)
//   tool.options(options);
//   const Input& boundary = tool.input("boundary", "PLY written by ngs-variance");
//   const Output& out = tool.output("-o,--output", "query PLY");
//   return tool.run(argc, argv, [&](Run& run) { ...; return 0; });
//
// Positional inputs come in the order of their declaration; a name that begins with '-' declares a flag. The references
// stay valid as long as the tool and hold paths when the body runs. Before the body runs: every given input exists, no
// output exists (unless -w), no output is also an input, no two outputs are one file, and the folders of the outputs
// exist: missing ones are created, and removed if the body fails. A dry run needs no output. "-" is stdin or stdout
// (run/streams.h); the report then goes to --report only.
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>

#include "ngs/options/option_set.h"
#include "shared/cli/arguments.h"
#include "shared/cli/exit_code.h"
#include "shared/cli/spec.h"
#include "shared/run/run.h"

namespace ngs::cli {

class Tool {
 public:
  /// `examples`: at least one command line; the first two open the help text.
  Tool(std::string name, std::string summary, std::initializer_list<std::string> examples);
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  /// Any number of structs with describe(). Given options of a group that does not apply are warned about first.
  template <class Options>
  void options(Options& options, OptionGroup group = {}) {
    option_set().add(options, std::move(group));
  }
  /// `prefix` goes before their option names ("fit_" -> --fit-steps).
  template <class Options>
  void options(Options& options, std::string_view prefix) {
    option_set().add(options, prefix);
  }
  /// For code that adds its own groups.
  OptionSet& option_set() { return spec_.options; }
  const Input& input(std::string name, std::string help) { return add_input(std::move(name), std::move(help), true); }
  /// `also`: a second flag for the same input.
  const Input& optional_input(std::string name, std::string help, std::string also = {}) {
    return add_input(std::move(name), std::move(help), false, std::move(also));
  }
  /// A positional name: one or more paths after the other positionals. A flag: any number, repeated or by commas.
  const Inputs& inputs(std::string name, std::string help) {
    return spec_.input_lists.emplace_back(Inputs{std::move(name), std::move(help), {}});
  }
  const Argument& argument(std::string name, std::string help);
  const Output& output(std::string flags, std::string help) {
    return add_output(std::move(flags), std::move(help), true, false);
  }
  const Output& optional_output(std::string flags, std::string help) {
    return add_output(std::move(flags), std::move(help), false, false);
  }
  const Output& output_dir(std::string flags, std::string help) {
    return add_output(std::move(flags), std::move(help), true, true);
  }
  const Output& optional_output_dir(std::string flags, std::string help) {
    return add_output(std::move(flags), std::move(help), false, true);
  }
  /// Optional folder that may contain the files of an earlier run, with or without -w. The tool creates it and checks
  /// its contents.
  const Output& resumed_output_dir(std::string flags, std::string help);
  /// If this option is set the tool writes nothing and needs no output, as in a dry run.
  void writes_nothing_if(const bool& option) { spec_.writes_nothing_if.push_back(&option); }
  /// A section of --help after the options, also shown by --help NAME. Called once the command line is parsed; an empty
  /// text is not shown.
  void help(std::string name, std::function<std::string(bool in_full)> text) {
    spec_.help_topics.push_back({std::move(name), std::move(text)});
  }
  /// For a tool that people run: the JSON report is written to --report, or with --json to stdout, never unrequested.
  void reports_on_request() { spec_.reports_on_request = true; }
  /// The body polls monitor().stop_requested(). It has 0.3 s to return after a signal, or unlimited time while a
  /// SignalGrace exists (run/signals.h). Without this call a signal ends the tool at once, without output.
  void stops_on_request() { spec_.stops_on_request = true; }
  /// The body's ops have a device path. Without this call --device cuda is an error. With --device auto, the body may
  /// run twice: again on the CPU if the device's memory did not suffice (Run::is_restart()).
  void runs_on_device() { spec_.runs_on_device = true; }

  /// Returns the exit code. The body returns kDone, kCheckFailed, kBudgetHit or run.stop_code().
  int run(int argc, char** argv, const std::function<int(Run&)>& body);

 private:
  Input& add_input(std::string name, std::string help, bool required, std::string also = {});
  void add_positional(const std::string& name, std::string& target);
  Output& add_output(std::string flags, std::string help, bool required, bool directory);

  Spec spec_;
};

}  // namespace ngs::cli
