#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured (the capture of BENCHMARKS.md, one run on an idle machine of two cores (wall: 3, 38 and 102 s); reference was not run):\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          5.1  0.9668  0.9345  0.7462\n"
    "  standard      72.6  0.9693  0.9422  0.7660\n"
    "  high         196.5  0.9692  0.9420  0.7672\n";

}  // namespace ngs::joint
