#pragma once
// Parses argv into CommonFlags and the values of a Spec.
#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"

namespace ngs::cli {

/// Fills the options (options file first, then flags), inputs and outputs of `spec`. Throws kUsage for invalid
/// arguments. Missing ones are left to check_required(), so that --help, --version, --print-options and --print-schema
/// need no inputs.
CommonFlags parse_command_line(int argc, char** argv, Spec& spec);

/// Throws kUsage if a required input or output is missing; a dry run and a run that writes nothing need no outputs.
void check_required(const Spec& spec, bool dry_run);

}  // namespace ngs::cli
