#pragma once
// Written by tests/bench/results.sh from tests/bench/results/qualities.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured: Bird, average of the splits every:4:0 to every:4:3; two threads\n"
    "  quality       IoU  B-IoU 0.02  B-IoU 0.005  wall s  CPU s\n"
    "  draft      0.9594      0.9211       0.7188     1.1    2.0\n"
    "  standard   0.9630      0.9297       0.7476     9.3   18.1\n"
    "  high       0.9634      0.9302       0.7497    14.2   27.6\n"
    "  reference  0.9633      0.9301       0.7492    26.0   50.8\n";

}  // namespace ngs::joint
