#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured (the capture of BENCHMARKS.md, one run on an idle machine of two cores (wall: 3 and 40 s); others not run):\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          5.5  0.9668  0.9344  0.7462\n"
    "  standard      78.1  0.9690  0.9406  0.7627\n";

}  // namespace ngs::joint
