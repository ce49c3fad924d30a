#include "shared/page/html.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "ngs/core/formatted.h"
#include "ngs/core/version.h"
#include "shared/page/style.h"

namespace ngs::cli {
namespace {

constexpr std::size_t kMaxListEntries = 200;  // maximum entries of a list on a page

bool all_objects(const Json& list) {
  for (const Json& entry : list)
    if (!entry.is_object()) return false;
  return !list.empty();
}

std::string cell_html(const Json& json) {
  return json.is_structured() && !json.empty() ? json_html(json) : escaped(json_text(json));
}

std::string list_table(const Json& list) {
  Table table;
  for (const Json& entry : list)
    for (const auto& [key, unused] : entry.items())
      if (std::find(table.head.begin(), table.head.end(), escaped(key)) == table.head.end())
        table.head.push_back(escaped(key));
  for (const Json& entry : list) {
    if (table.rows.size() == kMaxListEntries) break;
    std::vector<std::string> row(table.head.size());
    for (const auto& [key, value] : entry.items())
      row[std::size_t(std::find(table.head.begin(), table.head.end(), escaped(key)) - table.head.begin())] =
          cell_html(value);
    table.rows.push_back(std::move(row));
  }
  std::string html = table.html();
  if (list.size() > kMaxListEntries)
    html += "<p class=note>" + with_separators(std::int64_t(list.size() - kMaxListEntries)) +
            " more rows are not shown.</p>";
  return html;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  return out;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string decimal(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string with_separators(std::int64_t value) {
  std::string digits = std::to_string(value), out;
  const std::size_t first = value < 0;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > first && (digits.size() - i) % 3 == 0) out += "\u202f";
    out += digits[i];
  }
  return out;
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  if (seconds < 1) return decimal(1000 * seconds, 0) + "\u202fms";
  if (seconds < 100) return decimal(seconds, 1) + "\u202fs";
  const auto total = std::int64_t(std::llround(seconds));
  char text[64];
  std::snprintf(text, sizeof text, "%lld min %02lld s", static_cast<long long>(total / 60),
                static_cast<long long>(total % 60));
  return text;
}

std::string Table::html() const {
  std::string out = caption.empty() ? std::string() : "<p class=note>" + caption + "</p>";
  out += "<div class=scroll><table>";
  if (!head.empty()) {
    out += "<thead><tr>";
    for (const std::string& cell : head) out += "<th scope=col>" + cell + "</th>";
    out += "</tr></thead>";
  }
  out += "<tbody>";
  for (const auto& row : rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      out += (i == 0 ? "<th scope=row>" : "<td>") + row[i] + (i == 0 ? "</th>" : "</td>");
    out += "</tr>";
  }
  return out + "</tbody></table></div>";
}

std::string json_text(const Json& json) {
  if (json.is_string()) return json.get<std::string>();
  if (json.is_null()) return "–";
  if (json.is_boolean()) return json.get<bool>() ? "yes" : "no";
  if (json.is_number_integer()) return json.dump();
  if (json.is_number_float()) return formatted("%.6g", json.get<double>());
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string json_html(const Json& json) {
  if (json.is_object() && !json.empty()) {
    Table table;
    for (const auto& [key, value] : json.items()) table.rows.push_back({escaped(key), cell_html(value)});
    return table.html();
  }
  if (json.is_array() && all_objects(json)) return list_table(json);
  if (json.is_array()) {
    std::string text;
    for (std::size_t i = 0; i < std::min(json.size(), kMaxListEntries); ++i)
      text += (i ? ", " : "") + json_text(json[i]);
    return escaped(text) + (json.size() > kMaxListEntries ? ", …" : "");
  }
  return escaped(json_text(json));
}

const Json& value_at(const Json& json, std::initializer_list<std::string_view> keys) {
  static const Json kNothing;
  const Json* at = &json;
  for (std::string_view key : keys) {
    if (!at->is_object()) return kNothing;
    const auto found = at->find(std::string(key));
    if (found == at->end()) return kNothing;
    at = &*found;
  }
  return *at;
}

double number_at(const Json& json, std::initializer_list<std::string_view> keys) {
  const Json& value = value_at(json, keys);
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::string section(const std::string& id, const std::string& title, const std::string& body) {
  return "<section id=\"" + id + "\"><h2>" + title + "</h2>\n" + body + "</section>\n";
}

std::string details(const std::string& summary, const std::string& body) {
  return "<details><summary>" + summary + "</summary>" + body + "</details>\n";
}

std::string page_start(const std::string& title, const std::string& heading, const std::string& note) {
  return "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
         "content=\"width=device-width,initial-scale=1\"><meta http-equiv=Content-Security-Policy "
         "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\"><title>" +
         escaped(title) + "</title><style>" + kStyle + "</style></head>\n<body><header><h1>" + escaped(heading) +
         "</h1><p class=note>" + note + "</p></header>\n<main>";
}

std::string page_end() { return std::string("</main>\n<footer>ngs ") + kVersion + "</footer></body></html>\n"; }

}  // namespace ngs::cli
