#pragma once
// What the rows of a result take from the files that the tools and suites write. Every function throws kBadInput where
// its file cannot be read or is none of its kind.
#include <string>
#include <vector>

#include "result.h"

namespace ngs::results {

/// `value` to seven significant digits.
double rounded(double value);

/// metrics.json of ngs-eval -> {iou, biou, biou_005}, the means over its pairs; boundary IoU at 0.02 and 0.005 of the
/// image's diagonal.
Json read_scores(const std::string& path);

/// A tool's report -> {wall_s, cpu_s, peak_mib} of the whole process; cpu_s of all threads together.
Json read_times(const std::string& path);

/// Rows of a whole file, `kind` one of
///   benchmark   google-benchmark's JSON: the medians; kernel and isa of its name KERNEL/ISA (isa is - without),
///   cpu_ms, mega_pairs_s stability   stability.json: a row per kernel or group of small ones; cases, exact (of them
///   without a ratio), worst_ratio of the others,
///               textbook (cases that have such a form), textbook_wrong (of them NaN, Inf or a wrong answer),
///               textbook_ratio (the worst of the others), failed
std::vector<Json> read_rows(const std::string& kind, const std::string& path);

}  // namespace ngs::results
