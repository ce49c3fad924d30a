#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  the capture of BENCHMARKS.md, one run on two idle Zen 4 cores (wall: 2, 39 and 82 s); reference: Zen 5, a commit before\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          3.7  0.9670  0.9346  0.7471\n"
    "  standard      75.2  0.9695  0.9428  0.7697\n"
    "  high         160.2  0.9696  0.9428  0.7700\n"
    "  reference    341.7  0.9690  0.9414  0.7676\n";

}  // namespace ngs::joint
