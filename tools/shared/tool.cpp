#include "shared/tool.h"

#include <filesystem>
#include <locale>
#include <new>

#include "ngs/core/error.h"
#include "shared/cli/command_line.h"
#include "shared/os/machine.h"
#include "shared/run/execute.h"
#include "shared/run/report.h"
#include "shared/text/layout.h"

namespace ngs::cli {

Tool::Tool(std::string name, std::string summary, std::initializer_list<std::string> examples) {
  spec_.name = std::move(name);
  spec_.summary = std::move(summary);
  spec_.examples = examples;
}

Input& Tool::add_input(std::string name, std::string help, bool required, std::string also) {
  Input& input = spec_.inputs.emplace_back(
      Input{.name = std::move(name), .help = std::move(help), .required = required, .also = std::move(also)});
  if (input.name[0] != '-') add_positional(input.name, input.path);
  return input;
}

void Tool::add_positional(const std::string& name, std::string& target) {
  spec_.positionals.push_back(&target);
  spec_.positional_names.push_back(name);
}

Output& Tool::add_output(std::string flags, std::string help, bool required, bool directory) {
  return spec_.outputs.emplace_back(
      Output{.flags = std::move(flags), .help = std::move(help), .required = required, .directory = directory});
}

const Argument& Tool::argument(std::string name, std::string help) {
  Argument& argument = spec_.arguments.emplace_back(Argument{std::move(name), std::move(help), {}});
  add_positional(argument.name, argument.value);
  return argument;
}

const Output& Tool::resumed_output_dir(std::string flags, std::string help) {
  Output& output = add_output(std::move(flags), std::move(help), false, true);
  output.resumes = true;
  return output;
}

namespace {

/// Prints the help, version, schema or options if the command line requests one; false: it requests a run.
bool print_text(const Spec& spec, const CommonFlags& flags) {
  if (!flags.help.empty())
    print(help_text(spec, flags.help, terminal_columns()));
  else if (flags.short_help)
    print(short_help_text(spec, terminal_columns()));
  else if (flags.version)
    print(version_text(spec.name, flags.json));
  else if (flags.print_schema == "report")
    print_json(report_schema(spec));
  else if (!flags.print_schema.empty())
    print_json(spec.options.schema(spec.name + " options"));
  else if (flags.print_options)
    print_json(spec.options.to_json());
  else if (flags.print_commands)
    print("\n");
  else
    return false;
  return true;
}

/// Empty unless the folder that relative paths start from was deleted.
std::string hint_of_deleted_folder() {
  std::error_code gone;
  const bool exists = !std::filesystem::current_path(gone).empty();
  return exists ? "" : "the current folder was deleted, and relative paths start there: cd to another one";
}

/// The only place that turns exceptions into messages and exit codes.
int guarded(Console& console, const std::function<int()>& body) {
  try {
    return body();
  } catch (const Error& e) {
    const std::string deleted = e.code() == ErrorCode::kBadInput ? hint_of_deleted_folder() : "";
    console.error(e.what(), deleted.empty() ? e.remedy() : deleted);
    return int(e.code());
  } catch (const std::bad_alloc&) {
    console.error("out of memory", "estimate the memory with --dry-run");
    return int(ErrorCode::kEnvironment);
  } catch (const std::filesystem::filesystem_error& e) {
    console.error(e.what(), hint_of_deleted_folder());
    return int(ErrorCode::kEnvironment);
  } catch (const std::exception& e) {
    console.error(std::string("bug in ngs: ") + e.what(), "report it with the command line and --version");
    return kBug;
  }
}

}  // namespace

int Tool::run(int argc, char** argv, const std::function<int(Run&)>& body) {
  std::locale::global(std::locale::classic());
  os::keep_freed_memory();
  Console early(spec_.name, LogLevel::kWarning, LogFormat::kText);
  CommonFlags flags;
  const int parsed = guarded(early, [&] {
    flags = parse_command_line(argc, argv, spec_);
    return 0;
  });
  if (parsed != 0) return parsed;
  Console console(spec_.name, flags.shown_level(), flags.log_format);
  return guarded(console, [&] {
    if (flags.print_options)
      for (const std::string& warning : flags.warnings) console.warning(warning);
    return print_text(spec_, flags) ? kDone : execute(spec_, flags, console, body);
  });
}

}  // namespace ngs::cli
