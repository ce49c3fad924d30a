#pragma once
// The texts of -h, --help and --version. Rendered once the command line is read: options of groups that it turns off
// (OptionGroup::listens) are not shown.
#include <string>

#include "shared/cli/spec.h"

namespace ngs::cli {

/// At most 30 lines of 100 columns: what it is, two examples, inputs and outputs, the options a first user needs.
std::string short_help_text(const Spec& spec, int width);
/// `verbose`: with what the tool says about itself, and what the options of experts do.
std::string help_text(const Spec& spec, int width, bool verbose);
/// Of a tool or, in dispatch(), of several.
std::string version_text(const std::string& tool, bool json);

}  // namespace ngs::cli
