#pragma once
// Written by tests/bench/results.sh from tests/bench/results/qualities.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured: Bird, average of the splits every:4:0 to every:4:3; two threads\n"
    "  quality       IoU  B-IoU 0.02  B-IoU 0.005  wall s  CPU s\n"
    "  draft      0.9594      0.9211       0.7188     1.4    2.5\n"
    "  standard   0.9631      0.9299       0.7480    10.7   20.1\n"
    "  high       0.9633      0.9302       0.7490    16.2   30.6\n"
    "  reference  0.9633      0.9304       0.7500    28.6   54.2\n";

}  // namespace ngs::joint
