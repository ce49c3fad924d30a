#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  bird of BENCHMARKS.md, one run each, two threads of Zen 4: wall 2, 15, 27, 66 s (in slower hours up to half as much again)\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          3.0  0.9670  0.9346  0.7470\n"
    "  standard      28.8  0.9698  0.9434  0.7709\n"
    "  high          53.8  0.9696  0.9424  0.7699\n"
    "  reference    129.8  0.9695  0.9434  0.7712\n";

}  // namespace ngs::joint
