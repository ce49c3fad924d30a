#pragma once
// Helpers to write HTML. Text that comes from a file must go through escaped().
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/options/option_set.h"

namespace ngs::cli {

std::string escaped(std::string_view text);
std::string base64(std::span<const std::uint8_t> bytes);

/// A number with fixed decimals; an en dash if it is not finite.
std::string decimal(double value, int decimals);
std::string with_separators(std::int64_t value);  // 12 345 678
std::string duration(double seconds);             // 350 ms, 12.3 s, 4 min 05 s

/// The first cell of each row is the row heading. Cells are HTML.
struct Table {
  std::string caption = {};
  std::vector<std::string> head = {};
  std::vector<std::vector<std::string>> rows = {};
  std::string html() const;
};

/// Any JSON as HTML: objects as two columns, lists of objects as tables, the rest as text.
std::string json_html(const Json& json);
/// A scalar as text; a container as compact JSON.
std::string json_text(const Json& json);

/// The number at json[keys...], NaN if there is none.
double number_at(const Json& json, std::initializer_list<std::string_view> keys);
/// The value at json[keys...], null if there is none.
const Json& value_at(const Json& json, std::initializer_list<std::string_view> keys);

std::string section(const std::string& id, const std::string& title, const std::string& body);
std::string details(const std::string& summary, const std::string& body);

/// A page is page_start(), its body, page_end(), in the common style. Its security policy forbids loading and running
/// anything. `title`, `heading`: plain text; `note`: HTML.
std::string page_start(const std::string& title, const std::string& heading, const std::string& note);
std::string page_end();

}  // namespace ngs::cli
