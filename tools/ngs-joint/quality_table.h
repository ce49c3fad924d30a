#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  bird of BENCHMARKS.md, mean of four splits, one run each, two threads of Zen 4 in a slow hour: wall 2, 20, 32, 57 s\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          3.7  0.9594  0.9210  0.7187\n"
    "  standard      38.6  0.9632  0.9297  0.7478\n"
    "  high          60.9  0.9636  0.9306  0.7508\n"
    "  reference    109.9  0.9637  0.9308  0.7509\n";

}  // namespace ngs::joint
