#pragma once
// Written by tests/bench/results.sh from tests/bench/results/qualities.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured: Bird, average of the splits every:4:0 to every:4:3; two threads\n"
    "  quality       IoU  B-IoU 0.02  B-IoU 0.005  wall s  CPU s\n"
    "  flash      0.9506      0.9079       0.7046     0.0    0.0\n"
    "  draft      0.9610      0.9263       0.7298     4.6    8.4\n"
    "  standard   0.9630      0.9303       0.7467    19.3   36.0\n"
    "  high       0.9635      0.9316       0.7500    31.3   58.3\n"
    "  reference  0.9638      0.9310       0.7513    45.4   85.1\n";

}  // namespace ngs::joint
