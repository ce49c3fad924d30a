#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  bird of BENCHMARKS.md, one run each, two threads of an idle Xeon; wall 2, 26, 60, 160 s, in other hours 1.4 times less\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          3.7  0.9670  0.9346  0.7470\n"
    "  standard      50.3  0.9696  0.9432  0.7707\n"
    "  high         114.2  0.9696  0.9429  0.7697\n"
    "  reference    307.3  0.9687  0.9414  0.7660\n";

}  // namespace ngs::joint
