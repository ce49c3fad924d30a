#pragma once
// What is written from a result: the markdown table of a page, the text of a tool's help, one number.
#include <string>
#include <utility>
#include <vector>

#include "result.h"

namespace ngs::results {

/// The cells of the table: its head, then its lines. Rows with equal labels share a line; lines come in the order of
/// their first rows. The reference line of `change` and `ratio` is the first that has the same labels but the last one;
/// in it these columns are empty, and so is a cell that no row has a number for.
std::vector<std::vector<std::string>> cells_of(const Result& result);

/// The table, and a sentence that says commit, machine, command and time. Where `defaults`, the hash of what the tools
/// print now, is another than the result's, a sentence says so.
std::string markdown_of(const Result& result, const std::string& defaults);

/// The same cells in columns of equal width, as a C++ header: the constant kQualityTable of ngs-joint's help.
std::string help_header_of(const Result& result);

/// What `show` makes of the numbers under `key` of all rows that have every (key, value) of `where`; label, each,
/// change and ratio are refused. Throws kNothingFound where there is no such row.
double value_of(const Result& result, const std::string& key, Show show,
                const std::vector<std::pair<std::string, std::string>>& where);

}  // namespace ngs::results
