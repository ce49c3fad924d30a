#include "table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "ngs/core/error.h"

namespace ngs::results {
namespace {

using Cells = std::vector<std::string>;

/// Rows of the result that share one line of the table.
struct Line {
  Cells labels;
  std::vector<const Json*> rows;
};

std::string text_under(const Json& row, const std::string& key) {
  const auto at = row.find(key);
  return at != row.end() && at->is_string() ? at->get<std::string>() : "";
}

std::vector<Line> lines_of(const Result& result) {
  std::vector<Line> lines;
  for (const Json& row : result.rows) {
    Cells labels;
    for (const Column& column : result.columns)
      if (column.show == Show::kLabel) labels.push_back(text_under(row, column.key));
    auto line = std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return l.labels == labels; });
    if (line == lines.end()) line = lines.insert(line, Line{labels, {}});
    line->rows.push_back(&row);
  }
  return lines;
}

std::vector<double> numbers_of(const Line& line, const Column& column) {
  std::vector<double> numbers;
  for (const Json* row : line.rows) {
    if (!column.where_key.empty() && text_under(*row, column.where_key) != column.where_value) continue;
    if (const std::optional<double> number = number_of(*row, column.key)) numbers.push_back(*number);
  }
  return numbers;
}

/// 6.8e+05 is written 6.8e5, -0.00 as 0.00.
std::string number_text(double value, const Column& column, bool sign = false) {
  char text[64];
  const char* const format = column.scientific ? (sign ? "%+.*g" : "%.*g") : (sign ? "%+.*f" : "%.*f");
  std::snprintf(text, sizeof text, format, column.digits, value);
  std::string cell = text;
  if (const std::size_t at = cell.find("e+"); at != std::string::npos)
    cell.erase(at + 1, cell.find_first_not_of("+0", at + 1) - at - 1);
  if (cell.find_first_of("123456789") == std::string::npos) cell.erase(0, cell.find_first_not_of("+-"));
  return cell;
}

double aggregate(const std::vector<double>& numbers, Show show) {
  switch (show) {
    case Show::kMin: return *std::min_element(numbers.begin(), numbers.end());
    case Show::kMax: return *std::max_element(numbers.begin(), numbers.end());
    case Show::kMedian:
    case Show::kRatio: return median_of(numbers);
    default: return mean_of(numbers);
  }
}

const Line& reference_of(const std::vector<Line>& lines, const Line& line) {
  const auto shared = [](const Line& l) {
    return Cells(l.labels.begin(), l.labels.end() - (l.labels.empty() ? 0 : 1));
  };
  return *std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return shared(l) == shared(line); });
}

std::string cell_of(const std::vector<Line>& lines, const Line& line, const Column& column) {
  const std::vector<double> numbers = numbers_of(line, column);
  if (numbers.empty()) return "";
  if (column.show == Show::kEach) {
    std::string cell;
    for (const double number : numbers) cell += (cell.empty() ? "" : ", ") + number_text(number, column);
    return cell;
  }
  const double value = aggregate(numbers, column.show);
  if (column.show != Show::kChange && column.show != Show::kRatio) return number_text(value, column);
  const Line& reference = reference_of(lines, line);
  const std::vector<double> before = numbers_of(reference, column);
  if (&reference == &line || before.empty()) return "";
  const double by = aggregate(before, column.show);
  return column.show == Show::kChange ? number_text(value - by, column, true) : number_text(value / by, column) + "x";
}

std::string escaped(const std::string& cell) {
  std::string text;
  for (const char c : cell) text += c == '|' ? "\\|" : std::string(1, c);
  return text;
}

std::string duration_text(double seconds) {
  const bool short_one = seconds < 90;
  return std::to_string(std::lround(short_one ? seconds : seconds / 60)) + (short_one ? " s" : " min");
}

/// Characters of UTF-8 text.
std::size_t width_of(const std::string& text) {
  return std::size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string blanks(width - std::min(width, width_of(text)), ' ');
  return left ? text + blanks : blanks + text;
}

}  // namespace

std::vector<Cells> cells_of(const Result& result) {
  std::vector<Cells> table(1);
  for (const Column& column : result.columns)
    table[0].push_back(column.name + (column.unit.empty() ? "" : " " + column.unit));
  const std::vector<Line> lines = lines_of(result);
  for (const Line& line : lines) {
    std::size_t label = 0;
    table.emplace_back();
    for (const Column& column : result.columns)
      table.back().push_back(column.show == Show::kLabel ? line.labels[label++] : cell_of(lines, line, column));
  }
  return table;
}

std::string markdown_of(const Result& result, const std::string& defaults) {
  const std::vector<Cells> table = cells_of(result);
  std::string text;
  for (std::size_t i = 0; i < table.size(); ++i) {
    text += "|";
    for (const std::string& cell : table[i]) text += (cell.empty() ? " " : " " + escaped(cell) + " ") + "|";
    text += "\n";
    if (i > 0) continue;
    text += "|";
    for (const Column& column : result.columns) text += column.show == Show::kLabel ? "---|" : "---:|";
    text += "\n";
  }
  constexpr std::size_t kWidth = 140;  // maximum line width of a page
  const bool changed = !result.defaults.empty() && result.defaults != defaults;
  const std::string title = result.title + ".",
                    source = "Commit `" + result.commit + "`, " + result.machine +
                             (result.seconds > 0 ? ", " + duration_text(result.seconds) : "") + ": `" + result.command +
                             "`." + (changed ? " Tools' default options have changed since." : "");
  text += "\n" + title + (title.size() + source.size() < kWidth ? " " : "\n") + source;
  return text + "\n";
}

std::string help_header_of(const Result& result) {
  const std::vector<Cells> table = cells_of(result);
  std::string text =
      "#pragma once\n"
      "// Written by tests/bench/results.sh from tests/bench/results/" +
      result.question +
      ".json; do not edit.\n\n"
      "namespace ngs::joint {\n\n"
      "inline constexpr const char* kQualityTable =\n"
      "    \"quality, as measured: " +
      result.title + "\\n\"\n";
  for (std::size_t i = 0; i < table.size(); ++i) {
    std::string line = " ";
    for (std::size_t c = 0; c < result.columns.size(); ++c) {
      std::size_t width = 0;
      for (const Cells& cells : table) width = std::max(width, width_of(cells[c]));
      line +=
          " " + std::string(c == 0 ? 0 : 1, ' ') + padded(table[i][c], width, result.columns[c].show == Show::kLabel);
    }
    text += "    \"" + line + "\\n\"" + (i + 1 == table.size() ? ";" : "") + "\n";
  }
  return text + "\n}  // namespace ngs::joint\n";
}

double value_of(const Result& result, const std::string& key, Show show,
                const std::vector<std::pair<std::string, std::string>>& where) {
  if (show == Show::kLabel || show == Show::kEach || show == Show::kChange || show == Show::kRatio)
    throw Error(ErrorCode::kUsage, "value: expected mean, median, least or most");
  std::vector<double> numbers;
  for (const Json& row : result.rows) {
    const bool wanted = std::all_of(where.begin(), where.end(),
                                    [&](const auto& pair) { return text_under(row, pair.first) == pair.second; });
    const std::optional<double> number = number_of(row, key);
    if (wanted && number) numbers.push_back(*number);
  }
  if (numbers.empty())
    throw Error(ErrorCode::kNothingFound,
                result.question + ": no row has a number '" + key + "' under these conditions");
  return aggregate(numbers, show);
}

}  // namespace ngs::results
