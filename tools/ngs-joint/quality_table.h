#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured (the capture of BENCHMARKS.md, one run on an idle machine of two cores (wall: 3, 48 and 127 s); reference was not run):\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          5.1  0.9668  0.9343  0.7464\n"
    "  standard      92.9  0.9696  0.9430  0.7701\n"
    "  high         246.2  0.9696  0.9432  0.7707\n";

}  // namespace ngs::joint
