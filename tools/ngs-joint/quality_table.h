#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured (the capture of BENCHMARKS.md, one run on a busy machine; others not run):\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft         14.4  0.9669  0.9346  0.7465\n"
    "  standard     110.7  0.9693  0.9420  0.7666\n";

}  // namespace ngs::joint
