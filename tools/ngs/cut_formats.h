#pragma once
// The halves of ngs cut in the formats of --format.
#include <string>

#include "cut_options.h"
#include "shared/run/run.h"

namespace ngs::ngs_tool {

/// Throws kUsage for a format that is not written.
void check_formats(const CutOptions& options);

/// Writes object.EXT and background.EXT of the PLYs in `folder`, turned until the axis of --up is up.
void write_other_formats(cli::Run& run, const CutOptions& options, const std::string& folder);

}  // namespace ngs::ngs_tool
