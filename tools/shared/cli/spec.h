#pragma once
// What a tool has declared, and what its command line made of that. Internal to tools/shared.
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"
#include "shared/cli/arguments.h"

namespace ngs::cli {

/// A part of the help beside those of the options.
struct HelpTopic {
  std::string name;                               // --help NAME shows it
  std::function<std::string(bool in_full)> text;  // for --help NAME and --help all, or for --help; empty: not shown
};

struct Spec {
  std::string name, summary;
  std::vector<std::string> examples;
  OptionSet options;
  std::deque<Input> inputs;  // positional ones and flags
  std::deque<Inputs> input_lists;
  std::deque<Argument> arguments;
  std::deque<Output> outputs;
  std::vector<std::string*> positionals;      // paths and words in the order of declaration
  std::vector<std::string> positional_names;  // of the same
  std::vector<HelpTopic> help_topics;
  std::vector<const bool*> writes_nothing_if;
  bool stops_on_request = false, runs_on_device = false, partly_on_device = false;

  /// One of the options that make a run like a dry one is set.
  bool writes_nothing() const;
};

}  // namespace ngs::cli
