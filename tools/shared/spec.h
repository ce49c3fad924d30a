#pragma once
// What a tool declared and what its command line said. Internal to tools/shared.
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"
#include "shared/tool.h"

namespace ngs::cli {

enum class LogLevel { kError, kWarning, kInfo };
enum class LogFormat { kText, kJson };
enum class DeviceChoice { kCpu, kCuda, kAuto };

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
  std::vector<std::string> help_texts;
  std::vector<const bool*> writes_nothing_if;
  bool stops_on_request = false, runs_on_device = false, partly_on_device = false;
};

/// The flags that every tool has.
struct CommonFlags {
  bool help = false, version = false, json = false;
  bool quiet = false, verbose = false, dry_run = false, overwrite = false, allow_empty = false;
  LogLevel log_level = LogLevel::kWarning;
  LogFormat log_format = LogFormat::kText;
  DeviceChoice device = DeviceChoice::kAuto;
  std::optional<int> threads;
  std::uint64_t seed = 0;
  std::string options_file, report_path;
  std::vector<std::string> warnings;  // of options given by earlier names
  bool print_options = false;
  bool print_commands = false;  // for scripts that walk over all tools: one empty line (see dispatch())
  std::string print_schema;     // empty, "options" or "report"
};

}  // namespace ngs::cli
