#pragma once
// The texts of -h, --help [GROUP] and --version. They are rendered after the command line is parsed: -h and --help show
// the groups of options that apply (OptionGroup::applies).
#include <string>

#include "shared/cli/spec.h"

namespace ngs::cli {

/// At most 30 lines of 100 columns: purpose, examples, inputs and outputs, the options that a first user needs.
std::string short_help_text(const Spec& spec, int width);
/// At most 80 lines of 100 columns for kUsualHelp. `group` "all" shows every option, a group name the options of this
/// group. Throws kUsage for any other name.
std::string help_text(const Spec& spec, const std::string& group, int width);
/// The version of a tool, or of a tool with commands (dispatch()).
std::string version_text(const std::string& tool, bool json);

}  // namespace ngs::cli
