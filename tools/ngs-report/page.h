#pragma once
// The whole page from the folders of the runs.
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

/// One section per run; several runs are compared first. Problems found on the way are added to the runs. `atlas`:
/// folder for the error pictures of a single run, or empty.
std::string report_page(const Exec& exec, std::vector<RunFolder>& runs, const PictureOptions& options,
                        const std::string& atlas);

/// The comparison of the runs for people and for scripts.
std::string means_table(const std::vector<RunFolder>& runs);
Json means_json(const std::vector<RunFolder>& runs);

}  // namespace ngs::cli
