#include "shared/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>

#include "ngs/core/error.h"
#include "ngs/options/near_matches.h"
#include "ngs/options/option_warnings.h"
#include "shared/text_file.h"

namespace ngs::cli {
namespace {

using Texts = std::vector<std::string>;

constexpr NamedValue<LogLevel> kLogLevels[] = {
    {LogLevel::kError, "error"}, {LogLevel::kWarning, "warning"}, {LogLevel::kInfo, "info"}};
constexpr NamedValue<LogFormat> kLogFormats[] = {{LogFormat::kText, "text"}, {LogFormat::kJson, "json"}};
constexpr NamedValue<DeviceChoice> kDevices[] = {
    {DeviceChoice::kCpu, "cpu"}, {DeviceChoice::kCuda, "cuda"}, {DeviceChoice::kAuto, "auto"}};

/// The common flags that take a value, checked by the same code as the options of the method.
struct CommonValues {
  LogLevel log_level = LogLevel::kWarning;
  LogFormat log_format = LogFormat::kText;
  DeviceChoice device = DeviceChoice::kAuto;
  int threads = 1;
  std::uint64_t seed = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.log_level, Choice<LogLevel>{"log_level", "", kLogLevels});
    visit(self.log_format, Choice<LogFormat>{"log_format", "", kLogFormats});
    visit(self.device, Choice<DeviceChoice>{"device", "", kDevices});
    visit(self.threads, Field<int>{"threads", "", "", 1, 4096});
    visit(self.seed, Field<std::uint64_t>{"seed", "", "", 0, UINT64_MAX});
  }
};

/// CLI11 only splits argv here: every value is collected as text, one per occurrence (it would otherwise let
/// a list option swallow the positionals behind it), and all checks and messages are ours.
class Splitter {
 public:
  Splitter() {
    app_.set_help_flag();
    app_.allow_extras();
  }
  /// `old_flags` mean the same and are not suggested to anybody.
  void value(const std::string& flags, const std::string& old_flags = {}) {
    app_.add_option(flags + old_flags, texts_[flags])->take_all()->expected(1)->allow_extra_args(false);
    remember(flags);
  }
  void flag(const std::string& flags, const std::string& old_flags = {}) {
    app_.add_flag(flags + old_flags, texts_[flags])->take_all();
    remember(flags);
  }
  const Texts& operator[](const std::string& flags) const { return texts_.at(flags); }
  bool has(const std::string& flags) const { return !texts_.at(flags).empty(); }
  /// Whether this spelling is among the words, as "--flag" or "--flag=value".
  bool has_word(const std::string& flag) const {
    return std::ranges::any_of(words_, [&](const std::string& word) { return word.substr(0, word.find('=')) == flag; });
  }

  /// The words that belong to no flag.
  Texts split(int argc, char** argv) {
    Texts words(argv + std::min(argc, 1), argv + argc);
    const auto end_of_flags = std::find(words.begin(), words.end(), "--");
    Texts plain(end_of_flags == words.end() ? end_of_flags : end_of_flags + 1, words.end());
    words.erase(end_of_flags, words.end());
    words_ = words;
    std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
    try {
      app_.parse(words);
    } catch (const CLI::ArgumentMismatch& e) {  // its message begins with the flag
      const std::string message = e.what();
      throw Error(ErrorCode::kUsage, message.substr(0, message.find(':')) + ": no value given, expected one",
                  "see --help");
    } catch (const CLI::ParseError& e) {
      throw Error(ErrorCode::kUsage, e.what(), "see --help");
    }
    Texts rest;
    for (const std::string& word : app_.remaining()) {
      if (word.size() > 1 && word[0] == '-') refuse(word.substr(0, word.find('=')));
      rest.push_back(word);
    }
    rest.insert(rest.end(), plain.begin(), plain.end());
    return rest;
  }

 private:
  void remember(const std::string& flags) {
    for (std::size_t begin = 0; begin < flags.size();) {
      const std::size_t end = std::min(flags.find(',', begin), flags.size());
      known_.push_back(flags.substr(begin, end - begin));
      if (known_.back()[0] == '!') known_.back().erase(0, 1);
      begin = end + 1;
    }
  }
  [[noreturn]] void refuse(const std::string& word) const {
    const bool near = !near_matches(word, known_).empty();
    throw Error(ErrorCode::kUsage, "unknown flag '" + word + "'",
                near ? suggestion(word, known_) : "see --help");
  }

  CLI::App app_;
  std::map<std::string, Texts> texts_;
  Texts words_;  // up to "--"
  Texts known_;
};

/// "--name", of a switch "--name,!--no-name".
std::string flags_of(const OptionEntry& entry, const std::string& name) {
  const std::string flag = option_flag(name);
  return entry.kind == OptionKind::kBool ? flag + ",!--no" + flag.substr(1) : flag;
}
std::string option_flags(const OptionEntry& entry) { return flags_of(entry, entry.name); }
std::string old_flags(const OptionEntry& entry) { return entry.was.empty() ? "" : "," + flags_of(entry, entry.was); }
bool is_by_old_flag(const Splitter& splitter, const OptionEntry& entry) {
  const std::string flag = option_flag(entry.was);
  return splitter.has_word(flag) || (entry.kind == OptionKind::kBool && splitter.has_word("--no" + flag.substr(1)));
}

constexpr const char* kCommonSwitches[] = {"-h,--help",      "--version",     "--json",
                                           "-q,--quiet",     "-v,--verbose",  "-n,--dry-run",
                                           "-w,--overwrite", "--allow-empty", "--print-options"};
constexpr const char* kCommonTexts[] = {"--log-level", "--log-format", "--device", "-j,--threads",
                                        "--seed",      "--options",    "--report"};

void declare(const Spec& spec, Splitter& splitter) {
  for (const char* flags : kCommonSwitches) splitter.flag(flags);
  for (const char* flags : kCommonTexts) splitter.value(flags);
  splitter.flag("--print-schema");
  splitter.flag("--print-commands");
  for (const OptionEntry& entry : spec.options.entries())
    entry.kind == OptionKind::kBool ? splitter.flag(option_flags(entry), old_flags(entry))
                                    : splitter.value(option_flags(entry), old_flags(entry));
  for (const Input& input : spec.inputs)
    if (input.name[0] == '-') splitter.value(input.name);
  for (const Output& output : spec.outputs) splitter.value(output.flags);
}

CommonFlags common_flags(const Splitter& splitter) {
  CommonFlags flags;
  flags.help = splitter.has("-h,--help");
  flags.version = splitter.has("--version");
  flags.json = splitter.has("--json");
  flags.quiet = splitter.has("-q,--quiet");
  flags.verbose = splitter.has("-v,--verbose");
  flags.dry_run = splitter.has("-n,--dry-run");
  flags.overwrite = splitter.has("-w,--overwrite");
  flags.allow_empty = splitter.has("--allow-empty");
  flags.print_options = splitter.has("--print-options");
  flags.print_commands = splitter.has("--print-commands");
  if (splitter.has("--options")) flags.options_file = splitter["--options"].back();
  if (splitter.has("--report")) flags.report_path = splitter["--report"].back();

  CommonValues values;
  OptionSet set;
  set.add(values);
  for (const char* name : {"--log-level", "--log-format", "--device", "-j,--threads", "--seed"})
    if (splitter.has(name)) {
      std::string key = std::string(name).substr(std::string(name).find("--") + 2);
      std::replace(key.begin(), key.end(), '-', '_');
      set.set_text(key, splitter[name]);
    }
  flags.log_level = flags.quiet ? LogLevel::kError : flags.verbose ? LogLevel::kInfo : values.log_level;
  flags.log_format = values.log_format;
  flags.device = values.device;
  if (splitter.has("-j,--threads")) flags.threads = values.threads;
  flags.seed = values.seed;
  if (flags.json && !flags.version)
    throw Error(ErrorCode::kUsage, "unknown flag '--json'", "it goes with --version");
  return flags;
}

void assign_positionals(const Texts& words, Spec& spec) {
  std::size_t next = 0;
  for (std::string* target : spec.positionals)
    if (next < words.size()) *target = words[next++];
  for (Inputs& list : spec.input_lists)
    for (; next < words.size(); ++next) list.paths.push_back(words[next]);
  if (next < words.size())
    throw Error(ErrorCode::kUsage, "unexpected argument '" + words[next] + "'",
                "see --help for the order of the arguments");
}

/// The options file first, then the flags.
void set_options(const Splitter& splitter, const OptionSet& options, CommonFlags& flags) {
  std::vector<const OptionEntry*> by_old_name;
  if (!flags.options_file.empty())
    by_old_name = options.set_json(
        parse_json(read_text_file(flags.options_file, ErrorCode::kUsage), flags.options_file), flags.options_file);
  for (const OptionEntry& entry : options.entries()) {
    if (splitter.has(option_flags(entry))) options.set_text(entry.name, splitter[option_flags(entry)]);
    if (!entry.was.empty() && (std::ranges::count(by_old_name, &entry) > 0 || is_by_old_flag(splitter, entry)))
      flags.warnings.push_back(renamed_warning(entry));
  }
}

/// "-" is where the report goes anyway, unless an output does.
void settle_report(const Spec& spec, CommonFlags& flags) {
  if (flags.report_path != "-") return;
  for (const Output& output : spec.outputs)
    if (output.path == "-")
      throw Error(ErrorCode::kUsage, "--report: '-', expected a file: an output goes to stdout already");
  flags.report_path.clear();
}

}  // namespace

CommonFlags parse_command_line(int argc, char** argv, Spec& spec) {
  Splitter splitter;
  declare(spec, splitter);
  Texts words = splitter.split(argc, argv);
  CommonFlags flags = common_flags(splitter);
  if (splitter.has("--print-schema")) {
    const bool of_report = !words.empty() && words.front() == "report";
    if (!words.empty() && (of_report || words.front() == "options")) words.erase(words.begin());
    flags.print_schema = of_report ? "report" : "options";
  }
  assign_positionals(words, spec);
  set_options(splitter, spec.options, flags);
  for (Input& input : spec.inputs)
    if (input.name[0] == '-' && splitter.has(input.name)) input.path = splitter[input.name].back();
  for (Output& output : spec.outputs)
    if (splitter.has(output.flags)) output.path = splitter[output.flags].back();
  settle_report(spec, flags);
  return flags;
}

void check_required(const Spec& spec, bool dry_run) {
  const auto require = [](bool given, const std::string& name, const std::string& help) {
    if (!given) throw Error(ErrorCode::kUsage, name + ": not given, expected " + help, "see --help");
  };
  for (const Input& input : spec.inputs) require(!input.required || input, input.name, input.help);
  for (const Argument& argument : spec.arguments)
    require(!argument.value.empty(), argument.name, argument.help);
  for (const Inputs& list : spec.input_lists) require(!list.paths.empty(), list.name, list.help);
  const auto given = [](const bool* option) { return *option; };
  if (dry_run || std::any_of(spec.writes_nothing_if.begin(), spec.writes_nothing_if.end(), given)) return;
  for (const Output& output : spec.outputs)
    require(!output.required || output, output.flags.substr(output.flags.find("--")), output.help);
}

}  // namespace ngs::cli
