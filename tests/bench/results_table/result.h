#pragma once
// A measured result: one file tests/bench/results/QUESTION.json (data-schema/result.schema.json). Rows are
// single runs; columns define the table.
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ngs::results {

using Json = nlohmann::ordered_json;

/// Value of a column for the rows that share one table line.
enum class Show {
  kLabel,  // text; rows with the same labels share a line
  kMean,
  kMedian,
  kMin,
  kMax,
  kEach,    // the values of all rows, in order
  kChange,  // mean minus that of the reference line
  kRatio,   // median divided by that of the reference line
};

struct Column {
  std::string name;  // heading in the table
  std::string unit;  // printed after the name; empty: none
  std::string key;   // key in the rows
  Show show = Show::kLabel;
  int digits = 0;  // decimals; significant digits if `scientific`
  bool scientific = false;
  std::string where_key, where_value;  // only rows with this value of this key; empty: all
};

struct Result {
  std::string question, title;
  std::string commit;    // last commit that changed library or tools
  std::string machine;   // "two cores of AMD Zen 4"
  std::string command;   // command that repeats the measurement
  std::string defaults;  // hash of the tools' default options; empty: independent of options
  double seconds = 0;    // wall time of the measurement
  std::vector<Column> columns;
  Json rows = Json::array();  // objects: a string under every label and under "run", numbers elsewhere
};

/// Throws kBadInput unless `name` is label, mean, median, least, most, each, change or ratio.
Show show_of(std::string_view name);

/// Throws kBadInput for an unreadable or invalid file.
Result read_result(const std::string& path);

/// Text of the file, with a line per column and row, for comparison with diff.
std::string text_of(const Result& result);

/// Throws kBadInput if the file cannot be read.
std::string read_text(const std::string& path);

/// The number under `key` of a row; nullopt if absent or null.
std::optional<double> number_of(const Json& row, const std::string& key);

/// `values` must not be empty; the median of an even number of values is the mean of the middle two.
double mean_of(const std::vector<double>& values);
double median_of(std::vector<double> values);

}  // namespace ngs::results
