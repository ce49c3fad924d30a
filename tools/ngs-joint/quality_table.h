#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  the capture of BENCHMARKS.md, one run on an idle machine of two cores (wall: 1.8, 24 and 57 s; reference, busy: 320 s)\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          3.2  0.9669  0.9344  0.7466\n"
    "  standard      47.0  0.9696  0.9436  0.7705\n"
    "  high         111.5  0.9695  0.9431  0.7699\n"
    "  reference    341.7  0.9690  0.9414  0.7676\n";

}  // namespace ngs::joint
