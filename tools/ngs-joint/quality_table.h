#pragma once
// Written by tests/bench/results.sh from tests/bench/results/qualities.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured: Bird, average of the splits every:4:0 to every:4:3; two threads\n"
    "  quality       IoU  B-IoU 0.02  B-IoU 0.005  wall s  CPU s\n"
    "  flash      0.9506      0.9079       0.7046     0.0    0.0\n"
    "  draft      0.9617      0.9261       0.7371     7.6   13.7\n"
    "  standard   0.9630      0.9293       0.7464    13.8   25.1\n"
    "  high       0.9634      0.9304       0.7495    23.1   42.7\n"
    "  reference  0.9637      0.9310       0.7517    35.4   63.2\n";

}  // namespace ngs::joint
