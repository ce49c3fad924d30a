#include "shared/cli/help.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "ngs/core/version.h"
#include "ngs/ops/device/cuda_ops.h"
#include "shared/cli/common_flags.h"
#include "shared/cli/exit_code.h"
#include "shared/text/layout.h"
#include "shared/text/text_columns.h"

namespace ngs::cli {
namespace {

constexpr int kHelpColumn = 28;
constexpr std::ptrdiff_t kShortHelpLines = 30;

std::string row(const std::string& left, const std::string& help, int width) {
  const int column = std::min(kHelpColumn, width / 2);
  std::string start = "  " + left + "  ";
  start.append(std::size_t(std::max(0, column - columns_of(start))), ' ');
  return wrapped(std::move(start), help, {column, width}) + "\n";
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
  return text;
}

/// "0.5", "1e6": short, for people; the schema has all digits.
std::string shown_number(const Json& number) {
  const double value = number.get<double>();
  if (number.is_number_integer() && std::abs(value) < 1e5) return number.dump();
  char text[32];
  const std::to_chars_result end =
      std::abs(value) < 1e5 ? std::to_chars(text, text + sizeof text, value)
                            : std::to_chars(text, text + sizeof text, value, std::chars_format::scientific, 0);
  std::string shown(text, end.ptr);
  if (const std::size_t sign = shown.find("e+"); sign != shown.npos)
    shown.erase(sign + 1, shown[sign + 2] == '0' ? 2 : 1);
  return shown;
}

/// What is typed for a value: "N", "on|off".
std::string value_of(const OptionEntry& entry) {
  switch (entry.kind) {
    case OptionKind::kBool: return {};
    case OptionKind::kInteger: return " N";
    case OptionKind::kReal: return " X";
    case OptionKind::kText:
    case OptionKind::kTextList: return " " + (entry.unit.empty() ? "TEXT" : entry.unit);
    case OptionKind::kChoice: break;
  }
  std::string names;
  for (const std::string& choice : entry.choices) names += (names.empty() ? " " : "|") + choice;
  return names;
}

/// "--[no-]resume", "--steps N".
std::string flag_and_value(const OptionEntry& entry) {
  const std::string flag = option_flag(entry.name);
  return entry.kind == OptionKind::kBool ? "--[no-]" + flag.substr(2) : flag + value_of(entry);
}

std::string default_of(const OptionEntry& entry) {
  const Json& value = entry.default_value;
  if (value.is_boolean()) return value.get<bool>() ? "on" : "off";
  if (value.is_string()) return value.get<std::string>();
  return value.is_number() ? shown_number(value) : "";
}

std::string option_row(const OptionEntry& entry, int width) {
  std::string help = entry.help;
  if (entry.kind == OptionKind::kTextList && help.find("(repeatable)") == help.npos) help += " (repeatable)";
  std::string values = default_of(entry);
  if (!entry.min.is_null()) {
    if (!entry.unit.empty()) values += " " + entry.unit;
    values += "; " + shown_number(entry.min) + ".." + shown_number(entry.max);
  }
  if (!values.empty()) help += " [" + values + "]";
  return row(flag_and_value(entry), help, width);
}

struct Part {
  std::string title;
  std::vector<const OptionEntry*> entries;
};

/// The options by the titles of their groups, in the order in which these come first, without what nothing listens to.
std::vector<Part> parts_of(const OptionSet& options, bool basic_only) {
  std::vector<Part> parts;
  for (const OptionEntry& entry : options.entries()) {
    if (!is_heard(entry) || (basic_only && !entry.group->basic)) continue;
    auto part = std::ranges::find(parts, entry.group->title, &Part::title);
    if (part == parts.end()) part = parts.insert(part, {entry.group->title, {}});
    part->entries.push_back(&entry);
  }
  return parts;
}

/// "TITLE: --flag --flag", and further lines indented.
std::string flag_list(const std::string& title, const std::vector<const OptionEntry*>& entries,
                      const Margins& margins) {
  std::string flags;
  for (const OptionEntry* entry : entries) flags += " " + option_flag(entry->name);
  return wrapped(title + ":", flags, margins) + "\n";
}

/// The flags alone, for a tool that has many and says of none that it is basic.
std::string option_list(const std::vector<Part>& parts, int width) {
  std::vector<const OptionEntry*> all;
  for (const Part& part : parts) all.insert(all.end(), part.entries.begin(), part.entries.end());
  return "\n" + flag_list("options", all, {2, width});
}

std::string option_rows(const std::vector<Part>& parts, int width, bool verbose) {
  std::string text, named;
  for (const Part& part : parts) {
    if (!verbose && part.entries.front()->group->expert) {
      named += flag_list("  " + part.title, part.entries, {4, width});
      continue;
    }
    text += "\n" + part.title + (text.empty() ? " [default; range]:\n" : ":\n");
    for (const OptionEntry* entry : part.entries) text += option_row(*entry, width);
  }
  return text + (named.empty() ? "" : "\nfor experts, explained by --help -v:\n" + named);
}

/// Who would listen to the options that are not shown.
std::string other_listeners(const OptionSet& options, int width) {
  std::vector<std::string> listeners;
  for (const OptionEntry& entry : options.entries()) {
    const std::string& listener = entry.group->listener;
    if (!is_heard(entry) && !listener.empty() && std::ranges::find(listeners, listener) == listeners.end())
      listeners.push_back(listener);
  }
  if (listeners.empty()) return {};
  std::string text;
  for (const std::string& listener : listeners) text += (text.empty() ? "" : ", ") + listener;
  return "\n" + wrapped("not shown: options of", text + "; --help beside it shows them", {2, width}) + "\n";
}

/// Two in a line where both have room.
std::string common_rows(int width) {
  constexpr int kFlagColumns = 27;
  CommonFlags defaults;
  OptionSet common;
  common.add(defaults);
  std::string text, left;
  const auto end_line = [&](const std::string& right) {
    text += (right.empty() ? left : in_columns(left, width / 2) + right) + "\n";
    left.clear();
  };
  for (const OptionEntry& entry : common.entries()) {
    if (entry.help == kForScripts) continue;
    std::string cell = "  " + (entry.letter != '\0' ? std::string("-") + entry.letter + ", " : "") +
                       option_flag(entry.name) + value_of(entry) + "  ";
    cell.append(std::size_t(std::max(0, kFlagColumns - columns_of(cell))), ' ');
    const std::string help = entry.help + (entry.kind == OptionKind::kChoice ? " [" + default_of(entry) + "]" : "");
    cell = wrapped(std::move(cell), help, {kFlagColumns, width});
    const bool is_narrow = cell.find('\n') == cell.npos && columns_of(cell) <= width / 2;
    if (!left.empty()) {
      end_line(is_narrow ? cell : "");
      if (is_narrow) continue;
    }
    left = cell;
    if (!is_narrow) end_line("");
  }
  if (!left.empty()) end_line("");
  return text;
}

/// A command line: a flag stays with its value, and a line that goes on ends with a backslash.
std::string example(const std::string& command, int width) {
  const std::string kNoBreak = "\u00a0";
  std::string text = command;
  for (std::size_t at = text.find(" -"); at != text.npos; at = text.find(" -", at + 1)) {
    const std::size_t blank = text.find(' ', at + 1);
    if (blank != text.npos && text[blank + 1] != '-') text.replace(blank, 1, kNoBreak);
  }
  std::string lines = wrapped("  ", text, {6, width, " \\"});
  for (std::size_t at = lines.find(kNoBreak); at != lines.npos; at = lines.find(kNoBreak))
    lines.replace(at, kNoBreak.size(), " ");
  return lines + "\n";
}

std::string examples_and_usage(const Spec& spec, int width) {
  std::string text = wrapped(spec.name + ":", spec.summary, {2, width}) + "\n\nexamples:\n";
  for (const std::string& line : spec.examples) text += example(line, width);
  std::string words = "[options]";
  for (const std::string& name : spec.positional_names) words += " " + upper(name);
  for (const Inputs& list : spec.input_lists) words += " " + upper(list.name) + "...";
  for (const Output& output : spec.outputs)
    if (output.required)
      words += " " + output.flags.substr(0, output.flags.find(',')) + (output.directory ? " DIR" : " FILE");
  return text + "\n" + wrapped("usage: " + spec.name, words, {2, width}) + "\n";
}

std::string inputs_and_outputs(const Spec& spec, int width) {
  std::string text = "\ninputs and outputs (- is stdin or stdout):\n";
  for (const Argument& argument : spec.arguments) text += row(upper(argument.name), argument.help, width);
  for (const Input& input : spec.inputs)
    text += row(input.name[0] == '-' ? input.name + " PATH" : upper(input.name), input.help, width);
  for (const Inputs& list : spec.input_lists) text += row(upper(list.name) + "...", list.help, width);
  for (const Output& output : spec.outputs) {
    std::string flags = output.flags;
    if (const std::size_t comma = flags.find(','); comma != flags.npos) flags.insert(comma + 1, " ");
    text += row(flags + (output.directory ? " DIR" : " FILE"), output.help, width);
  }
  return text;
}

}  // namespace

std::string short_help_text(const Spec& spec, int width) {
  const std::string head = examples_and_usage(spec, width) + inputs_and_outputs(spec, width);
  const std::string tail =
      "\n" + wrapped("more:", "--help has all options, the flags of all tools and the exit codes", {2, width}) + "\n";
  std::vector<Part> parts = parts_of(spec.options, true);
  if (parts.empty()) parts = parts_of(spec.options, false);
  if (parts.empty()) return head + tail;
  std::string text = head + option_rows(parts, width, true) + tail;
  if (std::ranges::count(text, '\n') > kShortHelpLines) text = head + option_list(parts, width) + tail;
  return text;
}

std::string help_text(const Spec& spec, int width, bool verbose) {
  std::string text = examples_and_usage(spec, width) + inputs_and_outputs(spec, width);
  text += option_rows(parts_of(spec.options, false), width, verbose) + other_listeners(spec.options, width);
  for (const std::string& paragraph : spec.help_texts)
    if (verbose) text += "\n" + rewrapped(paragraph, width);
  text += "\nflags of all tools:\n" + common_rows(width);
  return text + "\n" + wrapped("exit codes:", kExitCodeHelp, {2, width}) + "\n";
}

std::string version_text(const std::string& tool, bool json) {
  const bool with_cuda = cuda_ops() != nullptr;
  const Json record = {{"tool", tool},
                       {"version", kVersion},
                       {"build_type", kBuildType},
                       {"compiler", __VERSION__},
                       {"cuda", with_cuda}};
  if (json) return record.dump(2) + "\n";
  return tool + " " + kVersion + " (" + kBuildType + ", compiler " + __VERSION__ + ", CUDA " +
         (with_cuda ? "on" : "off") + ")\n";
}

}  // namespace ngs::cli
