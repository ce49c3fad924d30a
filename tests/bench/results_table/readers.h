#pragma once
// Readers of result rows from files of tools and test suites. All throw kBadInput for an unreadable or wrong file.
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

/// metrics.json of ngs-eval --halves, of both halves with the uncut model -> the means as seen_biou, unseen_spikes_px,
/// … of the object alone, photos_psnr_db, new_ssim, … of the hole, flicker, outside_mean and outside_most.
Json read_halves(const std::string& path);

// clang-format off
/// Rows of a whole file, `kind` one of
///   benchmark   google-benchmark's JSON, medians only: kernel and isa from the name KERNEL/ISA (isa "-" if missing),
///               cpu_ms, mega_pairs_s
///   stability   stability.json, a row per kernel or group of small kernels: cases, exact (cases without a ratio),
///               worst_ratio of the other cases, textbook (cases with a textbook form), textbook_wrong (of these, NaN,
///               Inf or a wrong result), textbook_ratio (worst of the others), failed
// clang-format on
std::vector<Json> read_rows(const std::string& kind, const std::string& path);

}  // namespace ngs::results
