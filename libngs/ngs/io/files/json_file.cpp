#include "ngs/io/files/json_file.h"

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/options/strict_json.h"

namespace ngs::io {
namespace {

using nlohmann::json;

double finite_number(const json& value, const JsonReader& reader, const std::string& key) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) reader.fail(key, "a finite number");
  return value.get<double>();
}

}  // namespace

json parse_json(std::string_view text, const std::string& object) {
  return parse_strict_json<json>(text, object, ErrorCode::kBadInput);
}

json read_json_file(const std::string& path) { return parse_json(MappedFile(path).text(), path); }

JsonReader::JsonReader(const json& value, std::string where) : value_(value), where_(std::move(where)) {
  if (!value_.is_object())
    throw Error(ErrorCode::kBadInput, where_ + ": " + value_.type_name() + ", expected an object");
}

void JsonReader::fail(const std::string& key, const std::string& expected) const {
  const bool present = value_.contains(key);
  std::string found = present ? value_.at(key).dump(-1, ' ', true, json::error_handler_t::replace) : "missing";
  constexpr std::size_t kMaxShownBytes = 40;
  if (found.size() > kMaxShownBytes) found = found.substr(0, kMaxShownBytes) + "...";
  throw Error(ErrorCode::kBadInput, path_of(key) + ": " + found + ", expected " + expected);
}

bool JsonReader::has(const std::string& key) const {
  read_keys_.insert(key);
  return value_.contains(key) && !value_.at(key).is_null();
}

const json& JsonReader::at(const std::string& key) const {
  if (!has(key)) fail(key, "a value");
  return value_.at(key);
}

double JsonReader::number(const std::string& key) const { return finite_number(at(key), *this, key); }

double JsonReader::number(const std::string& key, double min, double max) const {
  const double value = number(key);
  if (!(value >= min && value <= max)) fail(key, "a number in [" + formatted("%g", min) + formatted(", %g]", max));
  return value;
}

std::int64_t JsonReader::integer(const std::string& key, std::int64_t min, std::int64_t max) const {
  const double value = number(key);  // 1024.0 is an integer too: nerfstudio writes sizes like that
  if (value != std::floor(value) || value < double(min) || value > double(max))
    fail(key, "an integer in [" + std::to_string(min) + ", " + std::to_string(max) + "]");
  return std::int64_t(value);
}

std::string JsonReader::text(const std::string& key, std::size_t max_bytes) const {
  const json& value = at(key);
  if (!value.is_string() || value.get_ref<const std::string&>().find('\0') != std::string::npos)
    fail(key, "a text without NUL characters");
  if (value.get_ref<const std::string&>().size() > max_bytes)
    fail(key, "at most " + std::to_string(max_bytes) + " bytes");
  return value.get<std::string>();
}

std::string JsonReader::text_or(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

bool JsonReader::boolean(const std::string& key) const {
  if (!at(key).is_boolean()) fail(key, "true or false");
  return at(key).get<bool>();
}

const json& JsonReader::array(const std::string& key) const {
  if (!at(key).is_array()) fail(key, "an array");
  return at(key);
}

JsonReader JsonReader::object(const std::string& key) const { return JsonReader(at(key), path_of(key)); }

std::vector<double> JsonReader::matrix(const std::string& key, std::size_t rows, std::size_t columns) const {
  const json& outer = array(key);
  const std::string expected = columns == 0 ? std::to_string(rows) + " numbers"
                                            : std::to_string(rows) + "x" + std::to_string(columns) + " numbers";
  if (outer.size() != rows) fail(key, expected);
  std::vector<double> out;
  for (const json& row : outer) {
    if (columns == 0) {
      out.push_back(finite_number(row, *this, key));
      continue;
    }
    if (!row.is_array() || row.size() != columns) fail(key, expected);
    for (const json& value : row) out.push_back(finite_number(value, *this, key));
  }
  return out;
}

void JsonReader::refuse_unknown_keys() const {
  for (const auto& item : value_.items())
    if (read_keys_.count(item.key()) == 0)
      throw Error(ErrorCode::kBadInput, (where_.empty() ? item.key() : where_) + ": unknown key \"" + item.key() +
                                            "\", expected only known ones");
}

}  // namespace ngs::io
