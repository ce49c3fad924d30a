#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured (the capture of BENCHMARKS.md, one run on an idle machine of two cores (wall: 2.3, 38 and 99 s); reference was not run):\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          4.1  0.9669  0.9344  0.7466\n"
    "  standard      74.1  0.9696  0.9436  0.7705\n"
    "  high         191.9  0.9695  0.9431  0.7699\n";

}  // namespace ngs::joint
