#pragma once
// The flags that every tool has, declared once like options: parser, --help and the report's schema read this list.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/options/field.h"

namespace ngs::cli {

enum class LogLevel { kError, kWarning, kInfo };
enum class LogFormat { kText, kJson };
enum class DeviceChoice { kCpu, kCuda, kAuto };

inline constexpr NamedValue<LogLevel> kLogLevels[] = {
    {LogLevel::kError, "error"}, {LogLevel::kWarning, "warning"}, {LogLevel::kInfo, "info"}};
inline constexpr NamedValue<LogFormat> kLogFormats[] = {{LogFormat::kText, "text"}, {LogFormat::kJson, "json"}};
inline constexpr NamedValue<DeviceChoice> kDevices[] = {
    {DeviceChoice::kCpu, "cpu"}, {DeviceChoice::kCuda, "cuda"}, {DeviceChoice::kAuto, "auto"}};

inline constexpr const char* kUsualHelp = "usual";         // the group shown by --help without a value
inline constexpr const char* kForScripts = "for scripts";  // not shown by --help

struct CommonFlags {
  bool short_help = false, version = false, json = false;
  std::string help;  // empty, kUsualHelp, "all" or the name of a group
  int threads = 0;   // 0: not given
  DeviceChoice device = DeviceChoice::kAuto;
  std::uint64_t seed = 0;
  bool dry_run = false, overwrite = false, allow_empty = false;
  std::string options_file, report_path;
  bool print_options = false;
  std::string print_schema;  // empty, "options" or "report"
  bool print_commands = false;
  bool quiet = false, verbose = false;
  LogLevel log_level = LogLevel::kWarning;
  LogFormat log_format = LogFormat::kText;

  std::vector<std::string> warnings;  // about options given by an earlier name

  LogLevel shown_level() const { return quiet ? LogLevel::kError : verbose ? LogLevel::kInfo : log_level; }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.short_help, Flag{"h", "Print a short help"});
    visit(self.help, Text{"help", "[GROUP]", "Print this or a group"});
    visit(self.version, Flag{"version", "Print version and build"});
    visit(self.json, Flag{"json", "Print the report on stdout"});
    visit(self.threads,
          Field<int>{"threads", "", "Threads to use; default: NGS_THREADS, or all cores", 1, 4096}.letter('j'));
    visit(self.device, Choice<DeviceChoice>{"device", "Device to use", kDevices});
    visit(self.seed, Field<std::uint64_t>{"seed", "", "Seed of all random choices", 0, UINT64_MAX});
    visit(self.dry_run, Flag{"dry_run", "Print the plan and stop"}.letter('n'));
    visit(self.overwrite, Flag{"overwrite", "Replace existing files"}.letter('w'));
    visit(self.allow_empty, Flag{"allow_empty", "Accept an empty result"});
    visit(self.options_file, Text{"options", "FILE.json", "Read options from this file; flags have precedence"});
    visit(self.print_options, Flag{"print_options", "Print options as JSON"});
    visit(self.print_schema, Text{"print_schema", "[report]", "Print a JSON schema"});
    visit(self.report_path, Text{"report", "FILE", "Write the JSON report to this file, not to stdout"});
    visit(self.quiet, Flag{"quiet", "Print errors only"}.letter('q'));
    visit(self.verbose, Flag{"verbose", "Print more on stderr"}.letter('v'));
    visit(self.log_level, Choice<LogLevel>{"log_level", "Least severe level on stderr", kLogLevels});
    visit(self.log_format, Choice<LogFormat>{"log_format", "Format of stderr lines", kLogFormats});
    visit(self.print_commands, Flag{"print_commands", kForScripts});
  }
};

}  // namespace ngs::cli
