#include "shared/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/options/near_matches.h"
#include "shared/text/text_file.h"

namespace ngs::cli {
namespace {

using Texts = std::vector<std::string>;

constexpr const char* kPrintSchema = "--print-schema";

/// "--name", or "--name,!--no-name" for a boolean option.
std::string option_flags(const OptionEntry& entry) {
  const std::string flag = option_flag(entry.name);
  return entry.kind == OptionKind::kBool ? flag + ",!--no" + flag.substr(1) : flag;
}
/// "-j,--threads"; common flags have no "--no-" form.
std::string common_flags(const OptionEntry& entry) {
  return (entry.letter != '\0' ? std::string("-") + entry.letter + "," : "") + option_flag(entry.name);
}
/// "--model,--ply"
std::string input_flags(const Input& input) { return input.also.empty() ? input.name : input.name + "," + input.also; }

/// Splits argv into flags with values and positionals. CLI11 does nothing but this: every value is collected as text,
/// one per occurrence, because a CLI11 list option would consume the positionals after it. All checks and messages are
/// our own.
class Splitter {
 public:
  Splitter() {
    app_.set_help_flag();
    app_.allow_extras();
  }

  /// Adds a flag with a value. `flags` ("-o,--output") is its key below.
  void value(const std::string& flags) {
    app_.add_option(flags, texts_[flags])->take_all()->expected(1)->allow_extra_args(false);
    register_names(flags);
  }
  /// Adds a flag without a value, or with "=false". "--fast,!--no-fast": the second spelling means false.
  void flag(const std::string& flags) {
    app_.add_flag(flags, texts_[flags])->take_all();
    register_names(flags);
  }

  /// Returns the positionals of a command line. Throws kUsage for an unknown flag, or for a flag without its value.
  Texts split(Texts words) {
    const auto end_of_flags = std::find(words.begin(), words.end(), "--");
    Texts plain(end_of_flags == words.end() ? end_of_flags : end_of_flags + 1, words.end());
    words.erase(end_of_flags, words.end());
    std::reverse(words.begin(), words.end());  // CLI11 reads them from the back
    try {
      app_.parse(words);
    } catch (const CLI::ArgumentMismatch& e) {  // the message begins with the flag
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

  const Texts& operator[](const std::string& flags) const { return texts_.at(flags); }
  bool has(const std::string& flags) const { return !texts_.at(flags).empty(); }

 private:
  void register_names(const std::string& flags) {
    for (const std::string& name : CLI::detail::split(flags, ','))
      known_.push_back(name[0] == '!' ? name.substr(1) : name);
  }
  [[noreturn]] void refuse(const std::string& word) const {
    const bool near = !near_matches(word, known_).empty();
    throw Error(ErrorCode::kUsage, "unknown flag '" + word + "'", near ? suggestion(word, known_) : "see --help");
  }

  CLI::App app_;
  std::map<std::string, Texts> texts_;
  Texts known_;
};

void declare(const OptionSet& common, const Spec& spec, Splitter& splitter) {
  for (const OptionEntry& entry : common.entries())
    entry.kind == OptionKind::kBool ? splitter.flag(common_flags(entry)) : splitter.value(common_flags(entry));
  for (const OptionEntry& entry : spec.options.entries())
    entry.kind == OptionKind::kBool ? splitter.flag(option_flags(entry)) : splitter.value(option_flags(entry));
  for (const Input& input : spec.inputs)
    if (input.name[0] == '-') splitter.value(input_flags(input));
  for (const Inputs& list : spec.input_lists)
    if (list.is_flag()) splitter.value(list.name);
  for (const Output& output : spec.outputs) splitter.value(output.flags);
}

/// Flags whose value may be left out, and the value that they then have.
const std::pair<std::string, std::string> kWordIfAlone[] = {{kPrintSchema, "options"}, {"--help", kUsualHelp}};

Texts words_of(int argc, char** argv) {
  Texts words(argv + std::min(argc, 1), argv + argc);
  const auto end = std::find(words.begin(), words.end(), "--");
  for (const auto& [name, word] : kWordIfAlone) {
    const auto flag = std::find(words.begin(), end, name);
    if (flag != end && (flag + 1 == end || (flag + 1)->starts_with("-"))) *flag += "=" + word;
  }
  return words;
}

void check_common_flags(const CommonFlags& flags) {
  if (!flags.print_schema.empty() && flags.print_schema != "options" && flags.print_schema != "report")
    throw Error(ErrorCode::kUsage, kPrintSchema + (": '" + flags.print_schema) + "', expected options or report",
                std::string(kPrintSchema) + " alone means the options");
}

void assign_positionals(const Texts& words, Spec& spec) {
  std::size_t next = 0;
  for (std::string* target : spec.positionals)
    if (next < words.size()) *target = words[next++];
  for (Inputs& list : spec.input_lists)
    for (; next < words.size() && !list.is_flag(); ++next) list.paths.push_back(words[next]);
  if (next < words.size())
    throw Error(ErrorCode::kUsage, "unexpected argument '" + words[next] + "'",
                "see --help for the order of the arguments");
}

/// Sets the options from the options file first, then from the flags.
void set_options(const Splitter& splitter, const OptionSet& options, const CommonFlags& flags) {
  if (const std::string& path = flags.options_file; !path.empty())
    options.set_json(parse_json(read_text_file(path, ErrorCode::kUsage), path), path);
  for (const OptionEntry& entry : options.entries())
    if (splitter.has(option_flags(entry))) options.set_text(entry.name, splitter[option_flags(entry)]);
}

/// "a.json,b.json" is two paths unless a file has this name. Throws kUsage if one of several is empty.
void add_paths(const std::string& word, Inputs& list) {
  std::error_code unreadable;
  if (std::filesystem::exists(word, unreadable)) return list.paths.push_back(word);
  for (std::size_t begin = 0, end = 0; begin <= word.size(); begin = end + 1) {
    end = std::min(word.find(',', begin), word.size());
    if (end == begin) throw Error(ErrorCode::kUsage, list.name + ": '" + word + "', expected PATH or PATH,PATH,...");
    list.paths.push_back(word.substr(begin, end - begin));
  }
}

/// The last value of a flag. Throws kUsage if it is empty: the default would be used unnoticed.
std::string path_of(const Splitter& splitter, const std::string& flags) {
  const std::string& path = splitter[flags].back();
  if (path.empty())
    throw Error(ErrorCode::kUsage, flags + ": an empty path, expected a file or folder",
                "is a variable of the shell not set? Leave the option out to use its default");
  return path;
}

void set_paths(const Splitter& splitter, Spec& spec) {
  for (Input& input : spec.inputs)
    if (input.name[0] == '-' && splitter.has(input_flags(input))) input.path = path_of(splitter, input_flags(input));
  for (Inputs& list : spec.input_lists)
    if (list.is_flag() && splitter.has(list.name))
      for (const std::string& word : splitter[list.name]) add_paths(word, list);
  for (Output& output : spec.outputs)
    if (splitter.has(output.flags)) output.path = path_of(splitter, output.flags);
}

/// Resolves `--report -`: stdout, which is the default anyway. Throws kUsage if an output goes to stdout.
void settle_report(const Spec& spec, CommonFlags& flags) {
  const bool to_stdout = flags.report_path == "-";
  for (const Output& output : spec.outputs)
    if (output.path == "-" && (to_stdout || flags.json))
      throw Error(ErrorCode::kUsage, std::string(to_stdout ? "--report: '-'" : "--json") +
                                         ", expected --report FILE: an output already goes to stdout");
  if (to_stdout) {
    flags.report_path.clear();
    flags.json = true;
  }
}

}  // namespace

CommonFlags parse_command_line(int argc, char** argv, Spec& spec) {
  CommonFlags flags;
  OptionSet common;
  common.add(flags);
  Splitter splitter;
  declare(common, spec, splitter);
  const Texts words = splitter.split(words_of(argc, argv));
  for (const OptionEntry& entry : common.entries())
    if (splitter.has(common_flags(entry))) common.set_text(entry.name, splitter[common_flags(entry)]);
  check_common_flags(flags);
  assign_positionals(words, spec);
  set_options(splitter, spec.options, flags);
  set_paths(splitter, spec);
  settle_report(spec, flags);
  return flags;
}

void check_required(const Spec& spec, bool dry_run) {
  const auto require = [](bool given, const std::string& name, const std::string& help) {
    if (!given) throw Error(ErrorCode::kUsage, name + ": missing, expected " + help, "see --help");
  };
  for (const Input& input : spec.inputs) require(!input.required || input, input.name, input.help);
  for (const Argument& argument : spec.arguments) require(!argument.value.empty(), argument.name, argument.help);
  for (const Inputs& list : spec.input_lists) require(list.is_flag() || list, list.name, list.help);
  if (dry_run || spec.writes_nothing()) return;
  for (const Output& output : spec.outputs)
    require(!output.required || output, output.long_flag(), "where to write: " + output.help);
}

}  // namespace ngs::cli
