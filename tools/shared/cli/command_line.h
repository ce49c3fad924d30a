#pragma once
// Parses argv into CommonFlags and the values of a Spec.
#include <string>

#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"

namespace ngs::cli {

/// Fills the options (options file first, then flags), inputs and outputs of `spec`. Throws kUsage for invalid
/// arguments. Missing ones are left to check_required(), so that --help, --version, --print-options and --print-schema
/// need no inputs.
CommonFlags parse_command_line(int argc, char** argv, Spec& spec);

/// Throws kUsage if a required input or output is missing; a dry run and a run that writes nothing need no outputs.
void check_required(const Spec& spec, bool dry_run);

// The texts of -h, --help [GROUP] and --version. They are rendered after the command line is parsed: -h and --help show
// the groups of options that apply (OptionGroup::applies).

/// At most 30 lines of 100 columns: purpose, examples, inputs and outputs, the options that a first user needs.
std::string short_help_text(const Spec& spec, int width);
/// At most 80 lines of 100 columns for kUsualHelp. `group` "all" shows every option, a group name the options of this
/// group. Throws kUsage for any other name.
std::string help_text(const Spec& spec, const std::string& group, int width);
/// The version of a tool, or of a tool with commands (dispatch()).
std::string version_text(const std::string& tool, bool json);

}  // namespace ngs::cli
