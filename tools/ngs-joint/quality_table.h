#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  the capture of BENCHMARKS.md, one run on two Zen 4 cores, idle (wall: 2, 38, 101 and 277 s)\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          3.9  0.9670  0.9346  0.7471\n"
    "  standard      73.0  0.9695  0.9428  0.7697\n"
    "  high         195.9  0.9696  0.9428  0.7700\n"
    "  reference    531.0  0.9690  0.9417  0.7683\n";

}  // namespace ngs::joint
