#pragma once
// Figures of a run, and of several.
#include <string>
#include <string_view>
#include <vector>

#include "run_folder.h"

namespace ngs::cli {

/// Seconds a run took: the sum over its tools' reports, without scoring.
double run_seconds(const RunFolder& run);
/// As the report of ngs-joint says; an en dash where there is none.
std::string method_of(const RunFolder& run);
/// What people call it: "COB-GS".
std::string method_title(const RunFolder& run);

std::string score_title(std::string_view name);  // "biou" -> "B-IoU 2&nbsp;%", HTML
/// Over the runs that have the score; NaN if none has.
double mean_over_runs(const std::vector<RunFolder>& runs, std::string_view score);

}  // namespace ngs::cli
