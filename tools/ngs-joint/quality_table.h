#pragma once
// Written by tests/bench/results.sh from tests/bench/results/qualities.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured: Bird, average of the splits every:4:0 to every:4:3; two threads\n"
    "  quality       IoU  B-IoU 0.02  B-IoU 0.005  wall s  CPU s\n"
    "  flash      0.9506      0.9079       0.7046     0.0    0.0\n"
    "  draft      0.9617      0.9272       0.7381     6.4   11.9\n"
    "  standard   0.9631      0.9296       0.7472    16.5   30.8\n"
    "  high       0.9633      0.9303       0.7499    25.7   48.2\n"
    "  reference  0.9632      0.9304       0.7494    44.6   84.1\n";

}  // namespace ngs::joint
