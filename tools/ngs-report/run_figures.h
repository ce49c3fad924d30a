#pragma once
// Derived numbers of one or more runs.
#include <string>
#include <string_view>
#include <vector>

#include "run_folder.h"

namespace ngs::cli {

/// Wall time of a run in seconds: sum over its tools' reports, without scoring.
double run_seconds(const RunFolder& run);
/// Option --method in the report of ngs-joint; an en dash without a report.
std::string method_of(const RunFolder& run);
/// Display name of the method: "COB-GS".
std::string method_title(const RunFolder& run);

std::string score_title(std::string_view name);  // "biou" -> "B-IoU 2&nbsp;%", HTML
/// Mean over the runs with this score; NaN if no run has it.
double mean_over_runs(const std::vector<RunFolder>& runs, std::string_view score);

}  // namespace ngs::cli
