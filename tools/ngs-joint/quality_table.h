#pragma once
// Written by pipelines/results.sh from tests/bench/results/qualities.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured: The capture bird, every:4:2 held out; times of ngs-joint on two threads\n"
    "  quality       IoU  B-IoU 0.02  B-IoU 0.005  wall s  CPU s\n"
    "  draft      0.9670      0.9346       0.7470     9.3    3.4\n"
    "  standard   0.9698      0.9434       0.7709    84.7   29.2\n"
    "  high       0.9694      0.9422       0.7679   156.5   46.0\n"
    "  reference  0.9692      0.9424       0.7671   184.7   77.7\n";

}  // namespace ngs::joint
