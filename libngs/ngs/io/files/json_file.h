#pragma once
// Reads untrusted JSON with one parser setting and one class for fields. Every reader thus rejects the same errors (not
// JSON, duplicate keys, wrong types, non-finite numbers) with a message that has the file and the key.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace ngs::io {

/// Duplicate keys and trailing text are kBadInput. `object` names the text in messages.
nlohmann::json parse_json(std::string_view text, const std::string& object);
nlohmann::json read_json_file(const std::string& path);

/// One JSON object. `where` locates it in messages: "scene.json: views[3]"; empty: keys alone do. The JSON must outlive
/// the reader.
class JsonReader {
 public:
  JsonReader(const nlohmann::json& value, std::string where);

  bool has(const std::string& key) const;  // present and not null
  double number(const std::string& key) const;
  double number(const std::string& key, double min, double max) const;
  double number_or(const std::string& key, double fallback) const { return has(key) ? number(key) : fallback; }
  std::int64_t integer(const std::string& key, std::int64_t min, std::int64_t max) const;
  std::string text(const std::string& key, std::size_t max_bytes = SIZE_MAX) const;  // without NUL characters
  std::string text_or(const std::string& key, const std::string& fallback) const;
  bool boolean(const std::string& key) const;
  bool boolean_or(const std::string& key, bool fallback) const { return has(key) ? boolean(key) : fallback; }
  const nlohmann::json& array(const std::string& key) const;
  JsonReader object(const std::string& key) const;
  /// Finite numbers, row by row from a nested array of exactly rows x columns; columns = 0: a flat array.
  std::vector<double> matrix(const std::string& key, std::size_t rows, std::size_t columns) const;
  const nlohmann::json& at(const std::string& key) const;

  /// kBadInput with the first key that none of the calls above has read.
  void refuse_unknown_keys() const;
  [[noreturn]] void fail(const std::string& key, const std::string& expected) const;
  const std::string& where() const { return where_; }

 private:
  std::string path_of(const std::string& key) const { return where_.empty() ? key : where_ + "." + key; }

  const nlohmann::json& value_;
  std::string where_;
  mutable std::set<std::string> read_keys_;
};

}  // namespace ngs::io
