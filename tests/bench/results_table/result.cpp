#include "result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <utility>

#include "ngs/core/error.h"

namespace ngs::results {
namespace {

constexpr std::array<const char*, 8> kShowNames{"label", "mean", "median", "least", "most", "each", "change", "ratio"};

Column column_of(const Json& json) {
  Column column;
  column.name = json.at("name");
  column.unit = json.value("unit", "");
  column.key = json.at("key");
  column.show = show_of(json.at("show").get<std::string>());
  column.digits = json.value("digits", 0);
  column.scientific = json.value("scientific", false);
  if (json.contains("where")) {
    column.where_key = json["where"].items().begin().key();
    column.where_value = json["where"].items().begin().value();
  }
  return column;
}

Json json_of(const Column& column) {
  Json json{{"name", column.name}};
  if (!column.unit.empty()) json["unit"] = column.unit;
  json["key"] = column.key;
  json["show"] = kShowNames[std::size_t(column.show)];
  if (column.show != Show::kLabel) json["digits"] = column.digits;
  if (column.scientific) json["scientific"] = true;
  if (!column.where_key.empty()) json["where"][column.where_key] = column.where_value;
  return json;
}

/// A JSON array with one element per line.
std::string lines_of(const std::vector<std::string>& elements) {
  std::string text = "[";
  for (std::size_t i = 0; i < elements.size(); ++i) text += (i == 0 ? "\n    " : ",\n    ") + elements[i];
  return text + "\n  ]";
}

}  // namespace

Show show_of(std::string_view name) {
  const auto* const at = std::find(kShowNames.begin(), kShowNames.end(), name);
  if (at == kShowNames.end())
    throw Error(ErrorCode::kBadInput, "column shows '" + std::string(name) +
                                          "', expected label, mean, median, least, most, each, change or ratio");
  return Show(at - kShowNames.begin());
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::kBadInput, path + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

Result read_result(const std::string& path) {
  try {
    const Json json = Json::parse(read_text(path));
    Result result;
    result.question = json.at("question"), result.title = json.at("title");
    result.commit = json.at("commit"), result.machine = json.at("machine");
    result.command = json.at("command"), result.defaults = json.at("defaults");
    result.seconds = json.at("seconds");
    for (const Json& column : json.at("columns")) result.columns.push_back(column_of(column));
    result.rows = json.at("rows");
    return result;
  } catch (const Json::exception& e) {
    throw Error(ErrorCode::kBadInput, path + ": " + e.what() + ", expected data-schema/result.schema.json");
  }
}

std::string text_of(const Result& result) {
  const std::vector<std::pair<const char*, Json>> head{{"question", result.question},
                                                       {"title", result.title},
                                                       {"commit", result.commit},
                                                       {"machine", result.machine},
                                                       {"command", result.command},
                                                       {"defaults", result.defaults},
                                                       {"seconds", std::llround(result.seconds)}};
  std::string text = "{\n";
  for (const auto& [key, value] : head) text += "  \"" + std::string(key) + "\": " + value.dump() + ",\n";
  std::vector<std::string> columns, rows;
  for (const Column& column : result.columns) columns.push_back(json_of(column).dump());
  for (const Json& row : result.rows) rows.push_back(row.dump());
  return text + "  \"columns\": " + lines_of(columns) + ",\n  \"rows\": " + lines_of(rows) + "\n}\n";
}

std::optional<double> number_of(const Json& row, const std::string& key) {
  const auto at = row.find(key);
  return at != row.end() && at->is_number() ? std::optional<double>(at->get<double>()) : std::nullopt;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace ngs::results
