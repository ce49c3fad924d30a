#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  the capture of BENCHMARKS.md, one run on two Zen 5 cores, idle (wall: 2, 26, 61 and 158 s)\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          2.9  0.9670  0.9346  0.7470\n"
    "  standard      50.5  0.9696  0.9430  0.7705\n"
    "  high         118.6  0.9695  0.9428  0.7696\n"
    "  reference    308.2  0.9691  0.9421  0.7700\n";

}  // namespace ngs::joint
