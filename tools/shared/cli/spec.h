#pragma once
// The declarations of a tool and their values from the command line. Internal to tools/shared.
#include <algorithm>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"
#include "shared/cli/arguments.h"

namespace ngs::cli {

/// A section of the help in addition to the options.
struct HelpTopic {
  std::string name;  // --help NAME shows it
  std::function<std::string(bool in_full)>
      text;  // in_full: for --help NAME and --help all; else for --help. Empty: not shown
};

struct Spec {
  std::string name, summary;
  std::vector<std::string> examples;
  OptionSet options;
  std::deque<Input> inputs;  // positional ones and flags
  std::deque<Inputs> input_lists;
  std::deque<Argument> arguments;
  std::deque<Output> outputs;
  std::vector<std::string*> positionals;      // paths and arguments in the order of declaration
  std::vector<std::string> positional_names;  // their names
  std::vector<HelpTopic> help_topics;
  std::vector<const bool*> writes_nothing_if;
  bool reports_on_request = false;  // without --json or --report there is no JSON on stdout
  bool stops_on_request = false, runs_on_device = false;

  bool writes_nothing() const {
    return std::ranges::any_of(writes_nothing_if, [](const bool* option) { return *option; });
  }
};

}  // namespace ngs::cli
