#pragma once
// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.

namespace ngs::joint {

inline constexpr const char* kQualityTable =
    "quality, as measured:\n"
    "  bird of BENCHMARKS.md, one run each, two threads of Zen 4, a slow hour: wall 3, 34, 77, 194 s (in others 2, 19 for the first two)\n"
    "              CPU s     IoU   B-IoU   0.005\n"
    "  draft          4.8  0.9670  0.9346  0.7470\n"
    "  standard      64.8  0.9697  0.9436  0.7711\n"
    "  high         147.2  0.9695  0.9428  0.7697\n"
    "  reference    370.4  0.9689  0.9419  0.7678\n";

}  // namespace ngs::joint
