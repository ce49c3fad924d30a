#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  the capture of BENCHMARKS.md, one run on two Xeon cores, idle (wall: 2, 28, 64 and 162 s)\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          3.3  0.9670  0.9346  0.7470\n"
    "  standard      54.1  0.9696  0.9428  0.7695\n"
    "  high         123.1  0.9696  0.9430  0.7706\n"
    "  reference    311.8  0.9690  0.9421  0.7683\n";

}  // namespace ngs::joint
