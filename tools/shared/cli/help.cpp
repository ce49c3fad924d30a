#include <algorithm>
#include <charconv>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/ops/device/cuda_ops.h"
#include "ngs/options/near_matches.h"
#include "shared/cli/command_line.h"
#include "shared/cli/common_flags.h"
#include "shared/cli/exit_code.h"
#include "shared/cli/version.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

constexpr int kHelpColumn = 30;
constexpr std::ptrdiff_t kShortHelpLines = 30;
constexpr const char* kAllGroups = "all";

std::string row(const std::string& left, const std::string& help, int width) {
  const int column = std::min(kHelpColumn, width / 2);
  std::string start = "  " + left + "  ";
  start.append(std::size_t(std::max(0, column - columns_of(start))), ' ');
  return wrapped(std::move(start), help, {column, width}) + "\n";
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
  return text;
}

/// A short number such as "0.5" or "1e6"; the schema has all digits.
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

/// Placeholder of a value: "N", "on|off".
std::string value_of(const OptionEntry& entry) {
  switch (entry.kind) {
    case OptionKind::kBool: return {};
    case OptionKind::kInteger: return " N";
    case OptionKind::kReal: return " X";
    case OptionKind::kText:
    case OptionKind::kTextList: return " " + (entry.unit.empty() ? "TEXT" : entry.unit);
    case OptionKind::kChoice: break;
  }
  return " " + joined(entry.choices, "|");
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
  std::string left = flag_and_value(entry), help = entry.help;
  if (entry.kind == OptionKind::kChoice && columns_of(left) > kHelpColumn - 4)  // too wide for the first column
  {
    left = option_flag(entry.name) + " NAME";
    help += ": " + joined(entry.choices, ", ");
  }
  if (entry.kind == OptionKind::kTextList && help.find("(repeatable)") == help.npos) help += " (repeatable)";
  std::string values = default_of(entry);
  if (!entry.min.is_null()) {
    if (!entry.unit.empty()) values += " " + entry.unit;
    values += "; " + shown_number(entry.min) + ".." + shown_number(entry.max);
  }
  if (!values.empty()) help += " [" + values + "]";
  return row(left, help, width);
}

struct Part {
  std::shared_ptr<const OptionGroup> group;
  std::vector<const OptionEntry*> entries;
};

/// The options by group, in the order in which the groups first occur.
std::vector<Part> parts_of(const OptionSet& options, const std::function<bool(const OptionEntry&)>& is_wanted) {
  std::vector<Part> parts;
  for (const OptionEntry& entry : options.entries()) {
    if (!is_wanted(entry)) continue;
    auto part = std::ranges::find_if(parts, [&](const Part& p) { return p.group->name == entry.group->name; });
    if (part == parts.end()) part = parts.insert(part, {entry.group, {}});
    part->entries.push_back(&entry);
  }
  return parts;
}

/// The options that apply and that a help text of length `least` shows.
std::vector<Part> used_parts(const OptionSet& options, Shown least) {
  return parts_of(options, [&](const OptionEntry& e) { return is_used(e) && e.group->shown <= least; });
}
std::vector<Part> all_parts(const OptionSet& options) {
  return parts_of(options, [](const OptionEntry&) { return true; });
}

/// The flags alone, for a tool whose option rows would not fit in the short help.
std::string option_list(const std::vector<Part>& parts, int width) {
  std::string flags;
  for (const Part& part : parts)
    for (const OptionEntry* entry : part.entries) flags += " " + option_flag(entry->name);
  return "\n" + wrapped("options:", flags, {2, width}) + "\n";
}

std::string option_rows(const std::vector<Part>& parts, int width) {
  std::string text;
  for (const Part& part : parts) {
    std::string title = part.group->name + (part.group->about.empty() ? "" : ": " + part.group->about);
    if (!is_used(*part.entries.front())) title += ", only with " + part.group->needs;
    text += "\n" + wrapped("", title + (text.empty() ? " [default; range]:" : ":"), {2, width}) + "\n";
    for (const OptionEntry* entry : part.entries) text += option_row(*entry, width);
  }
  return text;
}

/// Two common flags per line if both fit.
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

/// A command line in lines of `width`: a flag stays with its value, and a continued line ends with a backslash.
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
  for (const Inputs& list : spec.input_lists)
    if (!list.is_flag()) words += " " + upper(list.name) + "...";
  for (const Output& output : spec.outputs)
    if (output.required)
      words += " " + output.flags.substr(0, output.flags.find(',')) + (output.directory ? " DIR" : " FILE");
  return text + "\n" + wrapped("usage: " + spec.name, words, {2, width}) + "\n";
}

std::string inputs_and_outputs(const Spec& spec, int width) {
  const bool has_file = std::ranges::any_of(spec.outputs, [](const Output& output) { return !output.directory; });
  const bool takes_streams = spec.arguments.empty() || has_file;
  std::string text = takes_streams ? "\ninputs and outputs (- is stdin or stdout):\n" : "\ninputs and outputs:\n";
  for (const Argument& argument : spec.arguments) text += row(upper(argument.name), argument.help, width);
  for (const Input& input : spec.inputs)
    text += row(
        input.name[0] == '-' ? input.name + (input.also.empty() ? "" : ", " + input.also) + " PATH" : upper(input.name),
        input.help, width);
  for (const Inputs& list : spec.input_lists)
    text += row(list.is_flag() ? list.name + " PATH" : upper(list.name) + "...", list.help, width);
  for (const Output& output : spec.outputs) {
    std::string flags = output.flags;
    if (const std::size_t comma = flags.find(','); comma != flags.npos) flags.insert(comma + 1, " ");
    text += row(flags + (output.directory ? " DIR" : " FILE"), output.help, width);
  }
  return text;
}

std::vector<std::string> group_names(const Spec& spec) {
  std::vector<std::string> names;
  for (const Part& part : all_parts(spec.options)) names.push_back(part.group->name);
  for (const HelpTopic& topic : spec.help_topics) names.push_back(topic.name);
  names.push_back(kAllGroups);
  return names;
}

std::string group_text(const Spec& spec, const std::string& group, int width) {
  for (const HelpTopic& topic : spec.help_topics)
    if (topic.name == group) return rewrapped(topic.text(true), width);
  const auto parts = parts_of(spec.options, [&](const OptionEntry& entry) { return entry.group->name == group; });
  if (!parts.empty()) return option_rows(parts, width).substr(1);
  const std::vector<std::string> names = group_names(spec);
  throw Error(ErrorCode::kUsage, "--help: no group '" + group + "', expected " + joined(names, ", "),
              near_matches(group, names).empty() ? "" : suggestion(group, names));
}

/// The groups that plain --help omits or shortens.
std::string further_groups(const Spec& spec, int width) {
  std::vector<std::string> names = group_names(spec);
  for (const Part& part : used_parts(spec.options, Shown::kInHelp)) std::erase(names, part.group->name);
  for (const HelpTopic& topic : spec.help_topics)
    if (topic.text(true) == topic.text(false)) std::erase(names, topic.name);
  return names.size() < 2 ? "" : "\n" + wrapped("more: --help", joined(names, "|"), {2, width}) + "\n";
}

}  // namespace

std::string short_help_text(const Spec& spec, int width) {
  const std::string head = examples_and_usage(spec, width) + inputs_and_outputs(spec, width);
  const std::string tail =
      "\n" +
      wrapped("more:", "--help shows further options and the flags of all tools, --help all shows everything",
              {2, width}) +
      "\n";
  std::vector<Part> parts = used_parts(spec.options, Shown::kInShortHelp);
  if (parts.empty()) parts = used_parts(spec.options, Shown::kInHelp);
  if (parts.empty()) return head + tail;
  std::string text = head + option_rows(parts, width) + tail;
  if (std::ranges::count(text, '\n') > kShortHelpLines) text = head + option_list(parts, width) + tail;
  return text;
}

std::string help_text(const Spec& spec, const std::string& group, int width) {
  if (group != kUsualHelp && group != kAllGroups) return group_text(spec, group, width);
  const bool all = group == kAllGroups;
  std::string text = examples_and_usage(spec, width) + inputs_and_outputs(spec, width);
  text += option_rows(all ? all_parts(spec.options) : used_parts(spec.options, Shown::kInHelp), width);
  for (const HelpTopic& topic : spec.help_topics)
    if (const std::string table = topic.text(all); !table.empty()) text += "\n" + rewrapped(table, width);
  text += "\nflags of all tools:\n" + common_rows(width);
  text += "\n" + wrapped("exit codes:", kExitCodeHelp, {2, width}) + "\n";
  return all ? text : text + further_groups(spec, width);
}

std::string version_text(const std::string& tool, bool json) {
  const bool with_cuda = cuda_ops() != nullptr;
  const Json record = {{"tool", tool},
                       {"version", version_with_commit()},
                       {"build_type", kBuildType},
                       {"compiler", __VERSION__},
                       {"cuda", with_cuda}};
  if (json) return record.dump(2) + "\n";
  return tool + " " + version_with_commit() + " (" + kBuildType + ", compiler " + __VERSION__ + ", CUDA " +
         (with_cuda ? "on" : "off") + ")\n";
}

}  // namespace ngs::cli
