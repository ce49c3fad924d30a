#pragma once
// The whole page from the folders of the runs.
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

/// What a single run has beside its page.
struct BesidePage {
  std::string atlas;   // folder for its error pictures, or empty
  std::string viewer;  // where its object can be turned, as an address relative to the page, or empty
};

/// `to` as an address on a page at `page`, for HTML.
std::string address_from(const std::string& page, const std::string& to);

/// One section per run; several runs are compared first. Problems found on the way are added to the runs.
std::string report_page(const Exec& exec, std::vector<RunFolder>& runs, const PictureOptions& options,
                        const BesidePage& beside);

/// The comparison of the runs for people and for scripts.
std::string means_table(const std::vector<RunFolder>& runs);
Json means_json(const std::vector<RunFolder>& runs);

}  // namespace ngs::cli
