#pragma once
// A measured result: one file tests/bench/results/QUESTION.json (data-schema/result.schema.json). Its rows are the
// single runs; its columns say what a table shows of them.
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ngs::results {

using Json = nlohmann::ordered_json;

/// What a column shows of the rows that share one line of the table.
enum class Show {
  kLabel,  // text; rows with the same labels share a line
  kMean,
  kMedian,
  kLeast,
  kMost,
  kEach,    // every row's value, in their order
  kChange,  // the mean, less that of the reference line
  kRatio,   // the median, divided by that of the reference line
};

struct Column {
  std::string name;  // in the table's head
  std::string unit;  // behind the name; empty: none
  std::string key;   // of the rows
  Show show = Show::kLabel;
  int digits = 0;  // behind the point; significant ones where `scientific`
  bool scientific = false;
  std::string where_key, where_value;  // only rows with this value of this key; empty: all
};

struct Result {
  std::string question, title;
  std::string commit;    // the last one that changed the library or the tools
  std::string machine;   // "two cores of AMD Zen 4"
  std::string command;   // what measures it again
  std::string defaults;  // hash of the tools' default options; empty: no option has a part in it
  double seconds = 0;    // wall time of the measurement
  std::vector<Column> columns;
  Json rows = Json::array();  // objects: a string under every label and under "run", numbers elsewhere
};

/// Throws kBadInput where `name` is none of label, mean, median, least, most, each, change, ratio.
Show show_of(std::string_view name);

/// Throws kBadInput where a file cannot be read, or is no result.
Result read_result(const std::string& path);

/// The file's text: a line per column and per row, so that two of them can be compared by line.
std::string text_of(const Result& result);

/// Throws kBadInput where it cannot be read.
std::string read_text(const std::string& path);

/// The number under `key` of a row; none where it is absent or null.
std::optional<double> number_of(const Json& row, const std::string& key);

/// Mean of `values`, which are not empty; the median is the mean of the middle two where their number is even.
double mean_of(const std::vector<double>& values);
double median_of(std::vector<double> values);

}  // namespace ngs::results
