#pragma once
// Output of a result: markdown table of a page, help text of a tool, single numbers.
#include <string>
#include <utility>
#include <vector>

#include "result.h"

namespace ngs::results {

/// The cells of the table: heading, then lines. Rows with equal labels share a line; lines are ordered by their first
/// row. The reference line of `change` and `ratio` is the first line that agrees in all labels except the last; there
/// these columns are empty. Cells without a number are empty, too.
std::vector<std::vector<std::string>> cells_of(const Result& result);

/// The table, followed by title, commit, machine, command and time. A note is added if `defaults`, the hash of the
/// tools' current default options, differs from that of the result.
std::string markdown_of(const Result& result, const std::string& defaults);

/// The table as aligned text in a C++ header: the constant kQualityTable of ngs-joint's help.
std::string help_header_of(const Result& result);

/// Aggregates the numbers under `key` of all rows that match every (key, value) of `where`. Throws kUsage if `show` is
/// label, each, change or ratio, and kNothingFound without a matching row.
double value_of(const Result& result, const std::string& key, Show show,
                const std::vector<std::pair<std::string, std::string>>& where);

}  // namespace ngs::results
