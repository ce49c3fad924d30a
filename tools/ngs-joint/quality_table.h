#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured (the capture of BENCHMARKS.md, one run on a busy machine; others not run):\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft         12.2  0.9669  0.9346  0.7465\n"
    "  standard      44.1  0.9697  0.9417  0.7674\n";

}  // namespace ngs::joint
