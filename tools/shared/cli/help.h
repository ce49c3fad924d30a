#pragma once
// The texts of -h, --help [GROUP] and --version. Rendered once the command line is read: -h and --help show the groups
// of options that it lets listen (OptionGroup::applies).
#include <string>

#include "shared/cli/spec.h"

namespace ngs::cli {

/// At most 30 lines of 100 columns: what it is, two examples, inputs and outputs, the options a first user needs.
std::string short_help_text(const Spec& spec, int width);
/// At most 80 lines of 100 columns for kUsualHelp; "all" has every option, the name of a group those of this one.
/// kUsage for any other.
std::string help_text(const Spec& spec, const std::string& group, int width);
/// Of a tool or, in dispatch(), of several.
std::string version_text(const std::string& tool, bool json);

}  // namespace ngs::cli
