#pragma once
// The page for one or more run folders.
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

struct PageOutputs {
  std::string atlas;   // folder for error pictures, or empty
  std::string viewer;  // URL of the 3D page, relative to this page, or empty
};

/// URL of file `to`, relative to the page at path `page`.
std::string address_from(const std::string& page, const std::string& to);

/// One section per run, after a comparison of several runs. Adds problems found to the runs.
std::string report_page(const Exec& exec, std::vector<RunFolder>& runs, const PictureOptions& options,
                        const PageOutputs& outputs);

std::string means_table(const std::vector<RunFolder>& runs);
Json means_json(const std::vector<RunFolder>& runs);

}  // namespace ngs::cli
