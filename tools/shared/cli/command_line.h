#pragma once
// argv -> CommonFlags and the values of a Spec.
#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"

namespace ngs::cli {

/// Fills the options (options file first, then flags), inputs and outputs of `spec`. Throws Error(kUsage) for what
/// cannot be understood; what is missing is check_required()'s matter, so that --help, --version, --print-options and
/// --print-schema need no inputs.
CommonFlags parse_command_line(int argc, char** argv, Spec& spec);

/// A dry run, and what writes nothing, needs no outputs.
void check_required(const Spec& spec, bool dry_run);

}  // namespace ngs::cli
