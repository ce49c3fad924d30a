#include "collect.h"

#include <cmath>
#include <cstdio>
#include <set>
#include <sstream>

#include "ngs/core/error.h"
#include "readers.h"

namespace ngs::results {
namespace {

using Words = std::vector<std::string>;

[[noreturn]] void refuse(const std::string& found, const std::string& expected) {
  throw Error(ErrorCode::kBadInput, "'" + found + "', expected " + expected);
}

Words words_of(const std::string& line) {
  Words words;
  std::istringstream text(line);
  for (std::string word; std::getline(text, word, '\t');) words.push_back(word);
  return words;
}

std::pair<std::string, std::string> pair_of(const std::string& word) {
  const std::size_t at = word.find('=');
  if (at == std::string::npos || at == 0) refuse(word, "KEY=VALUE");
  return {word.substr(0, at), word.substr(at + 1)};
}

double number_of_text(const std::string& text) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || !std::isfinite(value)) refuse(text, "a finite number");
  return value;
}

void set_meta(Result& result, const std::string& key, const std::string& value) {
  if (key == "seconds")
    result.seconds = std::round(number_of_text(value));
  else if (key == "question")
    result.question = value;
  else if (key == "title")
    result.title = value;
  else if (key == "commit")
    result.commit = value;
  else if (key == "machine")
    result.machine = value;
  else if (key == "command")
    result.command = value;
  else if (key == "defaults")
    result.defaults = value;
  else
    refuse(key, "question, title, commit, machine, command, defaults or seconds");
}

Column column_of(const Words& words) {
  if (words.size() < 5) refuse(words.back(), "column NAME UNIT KEY SHOW [DIGITS] [WHERE]");
  Column column;
  column.name = words[1], column.unit = words[2], column.key = words[3], column.show = show_of(words[4]);
  if (column.show == Show::kLabel) return column;
  if (words.size() < 6 || words[5].empty()) refuse(words[1], "the DIGITS of this column");
  column.scientific = words[5].back() == 'g';
  column.digits = int(number_of_text(column.scientific ? words[5].substr(0, words[5].size() - 1) : words[5]));
  if (words.size() > 6) std::tie(column.where_key, column.where_value) = pair_of(words[6]);
  return column;
}

/// Keys with numbers: those shown by non-label columns.
std::set<std::string> numeric_keys(const Result& result) {
  std::set<std::string> keys;
  for (const Column& column : result.columns)
    if (column.show != Show::kLabel) keys.insert(column.key);
  return keys;
}

Json row_of(const Words& words, const std::set<std::string>& numeric) {
  Json row = Json::object();
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto [key, value] = pair_of(words[i]);
    if (key == "scores")
      row.update(read_scores(value));
    else if (key == "halves")
      row.update(read_halves(value));
    else if (key == "times")
      row.update(read_times(value));
    else if (numeric.count(key) != 0)
      row[key] = rounded(number_of_text(value));
    else
      row[key] = value;
  }
  return row;
}

/// Rows must differ in their labels, run, or keys that columns select by.
void refuse_repeated_rows(const Result& result) {
  std::set<std::string> seen;
  for (const Json& row : result.rows) {
    std::string name;
    for (const auto& [key, value] : row.items())
      if (value.is_string()) name += key + "=" + value.get<std::string>() + " ";
    if (!seen.insert(name).second) refuse(name, "unique rows; give each a run=NAME");
  }
}

}  // namespace

Result collect(std::istream& lines) {
  Result result;
  for (std::string line; std::getline(lines, line);) {
    const Words words = words_of(line);
    if (words.empty()) continue;
    if (words[0] == "meta" && words.size() >= 2) {
      set_meta(result, words[1], words.size() > 2 ? words[2] : "");
    } else if (words[0] == "column") {
      result.columns.push_back(column_of(words));
    } else if (words[0] == "row" && words.size() > 1) {
      result.rows.push_back(row_of(words, numeric_keys(result)));
    } else if (words[0] == "rows" && words.size() == 3) {
      for (Json& row : read_rows(words[1], words[2])) result.rows.push_back(std::move(row));
    } else {
      refuse(line, "meta, column, row or rows with their fields");
    }
  }
  refuse_repeated_rows(result);
  return result;
}

}  // namespace ngs::results
