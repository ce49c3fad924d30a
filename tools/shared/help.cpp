#include "shared/help.h"

#include <algorithm>

#include "ngs/core/version.h"
#include "ngs/ops/device/cuda_ops.h"
#include "shared/exit_code.h"

namespace ngs::cli {
namespace {

constexpr std::size_t kHelpColumn = 30;

std::string row(const std::string& left, const std::string& help) {
  const std::size_t width = left.size() + 2;
  const std::string gap =
      width < kHelpColumn ? std::string(kHelpColumn - width, ' ') : "\n" + std::string(kHelpColumn, ' ');
  return "  " + left + gap + help + "\n";
}

std::string flags_and_value(std::string flags, const std::string& value) {
  for (std::size_t comma = flags.find(','); comma != flags.npos; comma = flags.find(',', comma + 2))
    flags.insert(comma + 1, " ");
  return flags + " " + value;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
  return text;
}

std::string option_row(const OptionEntry& entry) {
  std::string left = option_flag(entry.name);
  std::string help = entry.help;
  switch (entry.kind) {
    case OptionKind::kBool:
      left += " / --no" + left.substr(1);
      break;
    case OptionKind::kInteger:
      left += " N";
      break;
    case OptionKind::kReal:
      left += " X";
      break;
    case OptionKind::kText:
    case OptionKind::kTextList:
      left += " " + (entry.unit.empty() ? "TEXT" : entry.unit);
      break;
    case OptionKind::kChoice: {
      std::string names;
      for (const std::string& choice : entry.choices) names += (names.empty() ? "" : "|") + choice;
      left += " " + names;
    }
  }
  if (entry.kind == OptionKind::kTextList && help.find("(repeatable)") == help.npos) help += " (repeatable)";
  std::string defaults =
      entry.default_value.is_string() ? entry.default_value.get<std::string>() : entry.default_value.dump();
  if (!entry.min.is_null()) {
    if (!entry.unit.empty()) defaults += " " + entry.unit;
    defaults += "; " + entry.min.dump() + " to " + entry.max.dump();
  }
  if (!defaults.empty() && defaults != "[]") help += " [" + defaults + "]";
  return row(left, help);
}

/// Group by group, in the order in which their titles come first; groups that nothing listens to are left out.
std::string option_rows(const OptionSet& options) {
  std::vector<std::pair<std::string, std::string>> parts;
  for (const OptionEntry& entry : options.entries()) {
    if (!is_heard(entry)) continue;
    auto part = std::ranges::find(parts, entry.group->title, &std::pair<std::string, std::string>::first);
    if (part == parts.end()) part = parts.insert(part, {entry.group->title, ""});
    part->second += option_row(entry);
  }
  std::string text;
  for (const auto& [title, rows] : parts) text += "\n" + title + " [default; range]:\n" + rows;
  return text;
}

constexpr const char* kCommonHelp =
    "common:\n"
    "  -h, --help                  this text\n"
    "      --version [--json]      version, build and libraries\n"
    "  -j, --threads N             [NGS_THREADS, SLURM_CPUS_PER_TASK, the CPUs of this process]\n"
    "      --device cpu|cuda|auto  where to compute; auto says what it chose and why [auto]\n"
    "      --seed N                of every random choice [0]\n"
    "  -n, --dry-run               read headers, print the plan, write nothing\n"
    "  -w, --overwrite             replace existing outputs; other files in the folder of an output stay\n"
    "      --allow-empty           an empty result is a result, not exit code 5\n"
    "      --options FILE.json     options from a file; flags win over it\n"
    "      --print-options         the resolved options as JSON\n"
    "      --print-schema [report] JSON Schema of the options, or of the report\n"
    "      --report FILE           the JSON report goes there instead of to stdout\n"
    "      -                       as a path: stdin, stdout (the report then needs --report)\n"
    "  -q, --quiet / -v, --verbose less / more on stderr\n"
    "      --log-level LEVEL       error|warning|info [warning]\n"
    "      --log-format FORMAT     text|json (one object per line) [text]\n";

}  // namespace

std::string help_text(const Spec& spec) {
  std::string text = spec.name + ": " + spec.summary + "\n\nexamples:\n";
  for (const std::string& example : spec.examples) text += "  " + example + "\n";

  text += "\nusage: " + spec.name + " [options]";
  for (const std::string& name : spec.positional_names) text += " " + upper(name);
  for (const Inputs& list : spec.input_lists) text += " " + upper(list.name) + "...";
  for (const Output& output : spec.outputs)
    if (output.required)
      text += " " + output.flags.substr(0, output.flags.find(',')) + (output.directory ? " DIR" : " FILE");

  text += "\n\ninputs and outputs:\n";
  for (const Argument& argument : spec.arguments) text += row(upper(argument.name), argument.help);
  for (const Input& input : spec.inputs)
    text += row(input.name[0] == '-' ? input.name + " PATH" : upper(input.name), input.help);
  for (const Inputs& list : spec.input_lists) text += row(upper(list.name) + "...", list.help);
  for (const Output& output : spec.outputs)
    text += row(flags_and_value(output.flags, output.directory ? "DIR" : "FILE"), output.help);

  text += option_rows(spec.options);
  for (const std::string& paragraph : spec.help_texts) text += "\n" + paragraph;
  return text + "\n" + kCommonHelp + "\n" + kExitCodeHelp;
}

std::string version_text(const Spec& spec, bool json) {
  const bool with_cuda = cuda_ops() != nullptr;
  const Json record = {{"tool", spec.name},
                       {"version", kVersion},
                       {"build_type", kBuildType},
                       {"compiler", __VERSION__},
                       {"cuda", with_cuda}};
  if (json) return record.dump(2) + "\n";
  return spec.name + " " + kVersion + " (" + kBuildType + ", compiler " + __VERSION__ + ", CUDA " +
         (with_cuda ? "on" : "off") + ")\n";
}

}  // namespace ngs::cli
