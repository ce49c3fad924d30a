#include "ngs/io/ply/ply_scan.h"

#include <algorithm>
#include <cstdlib>
#include <type_traits>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"

namespace ngs::io {
namespace {

// Location of an error; its text is built only when needed.
struct Place {
  const PlyBytes& file;
  const PlyElement& element;

  [[noreturn]] void bad(const std::string& message, std::string remedy = {}) const {
    throw Error(ErrorCode::kBadInput, file.name + ": " + message, std::move(remedy));
  }
  [[noreturn]] void truncated(std::int64_t row) const {
    bad("the data ends in row " + std::to_string(row) + " of element '" + printable(element.name) + "', expected " +
            std::to_string(element.count) + " rows",
        "the file is cut short: copy or download it again");
  }
};

bool has_list(const PlyElement& element) {
  return std::any_of(element.properties.begin(), element.properties.end(), [](const auto& p) { return p.is_list; });
}

/// The size of a row in which all lists are empty: the minimum row size.
std::size_t least_row_bytes(const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& p : element.properties) bytes += ply_type_bytes(p.is_list ? p.count_type : p.type);
  return bytes;
}

template <class Word, class Swap>
void copy_swapped(const std::uint8_t* from, std::uint8_t* to, Swap swap) {
  Word word;
  std::memcpy(&word, from, sizeof word);
  word = swap(word);
  std::memcpy(to, &word, sizeof word);
}

void load_little(PlyFormat format, PlyType type, const std::uint8_t* from, std::uint8_t* to) {
  const std::size_t bytes = ply_type_bytes(type);
  if (format != PlyFormat::kBinaryBig || bytes == 1)
    std::memcpy(to, from, bytes);
  else if (bytes == 2)
    copy_swapped<std::uint16_t>(from, to, [](std::uint16_t w) { return __builtin_bswap16(w); });
  else if (bytes == 4)
    copy_swapped<std::uint32_t>(from, to, [](std::uint32_t w) { return __builtin_bswap32(w); });
  else
    copy_swapped<std::uint64_t>(from, to, [](std::uint64_t w) { return __builtin_bswap64(w); });
}

std::size_t list_bytes(const Place& place, const PlyProperty& p, const std::uint8_t* from) {
  std::uint8_t little[8];
  load_little(place.file.format, p.count_type, from, little);
  const double count = PlyColumn{little, 8, p.count_type}.value(0);
  if (count < 0) place.bad("list '" + printable(p.name) + "' has a negative length, expected >= 0");
  return std::size_t(count) * ply_type_bytes(p.type);
}

/// Calls visit(property index, its bytes) for the scalars of the row at `at`; returns the end of the row.
template <class Visit>
std::size_t scan_binary_row(const Place& place, std::size_t at, std::int64_t row, const Visit& visit) {
  const Bytes bytes = place.file.bytes;
  const auto need = [&](std::size_t n) {
    if (n > bytes.size() - at) place.truncated(row);
  };
  for (std::size_t i = 0; i < place.element.properties.size(); ++i) {
    const PlyProperty& p = place.element.properties[i];
    std::size_t size = ply_type_bytes(p.is_list ? p.count_type : p.type);
    need(size);
    if (!p.is_list) visit(i, bytes.data() + at);
    const std::size_t list = p.is_list ? list_bytes(place, p, bytes.data() + at) : 0;
    at += size;
    need(list);
    at += list;
  }
  return at;
}

/// The next line that is not blank; moves `at` behind it.
std::string_view next_line(const Place& place, std::size_t& at, std::int64_t row) {
  const std::string_view text(reinterpret_cast<const char*>(place.file.bytes.data()), place.file.bytes.size());
  for (;;) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) {
      if (text.find_first_not_of(" \t\r", at) == std::string_view::npos) place.truncated(row);
      place.bad("row " + std::to_string(row) + " of element '" + printable(place.element.name) +
                    "' has no end of line, expected " + std::to_string(place.element.count) + " whole rows",
                "if the file is complete, end it with a newline: echo >> " + place.file.name);
    }
    const std::string_view line = text.substr(at, end - at);
    at = end + 1;
    if (line.find_first_not_of(" \t\r") != std::string_view::npos) return line;
  }
}

struct Tokens {
  std::string_view line;
  bool next(std::string_view& token) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return false;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    token = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return true;
  }
};

template <class T>
bool parse_token(std::string_view token, T& value) {
  if (token.starts_with('+')) token.remove_prefix(1);
  const auto [stop, status] = scan_number(token.data(), token.data() + token.size(), value);
  if (stop != token.data() + token.size()) return false;
  if constexpr (std::is_floating_point_v<T>) {
    // A finite decimal beyond T's range rounds to 0 or infinity; scan_number leaves `value` unchanged there.
    if (status == std::errc::result_out_of_range) {
      value = T(std::strtod(std::string(token).c_str(), nullptr));
      return true;
    }
  }
  return status == std::errc();
}

bool store_token(PlyType type, std::string_view token, std::uint8_t* to) {
  if (type == PlyType::kFloat32) {
    float v = 0;
    const bool ok = parse_token(token, v);
    ply_store_float(v, to);
    return ok;
  }
  double v = 0;
  if (!parse_token(token, v)) return false;
  ply_store(type, v, to);
  return type == PlyType::kFloat64 || PlyColumn{to, 8, type}.value(0) == v;  // integers must fit exactly
}

/// Parses a line of text into `to` (one packed row).
void parse_line(const Place& place, std::string_view line, std::int64_t row, std::uint8_t* to) {
  Tokens tokens{line};
  std::string_view token;
  const auto need_token = [&](const PlyProperty& p) {
    if (!tokens.next(token))
      place.bad("row " + std::to_string(row) + " of element '" + printable(place.element.name) +
                "' ends before property '" + printable(p.name) + "', expected one row per line");
  };
  const auto refuse = [&](const PlyProperty& p) {
    place.bad("row " + std::to_string(row) + ": '" + printable(token) + "' for property '" + printable(p.name) +
              "', expected a " + std::string(ply_type_name(p.is_list ? p.count_type : p.type)));
  };
  for (const PlyProperty& p : place.element.properties) {
    need_token(p);
    if (!p.is_list) {
      if (!store_token(p.type, token, to)) refuse(p);
      to += ply_type_bytes(p.type);
      continue;
    }
    std::int64_t count = 0;
    if (!parse_token(token, count) || count < 0) refuse(p);
    for (std::int64_t k = 0; k < count; ++k) need_token(p);
  }
  if (tokens.next(token))
    place.bad("row " + std::to_string(row) + " of element '" + printable(place.element.name) +
              "' has more values than its " + std::to_string(place.element.properties.size()) + " properties");
}

}  // namespace

std::size_t element_end(const PlyBytes& file, const PlyElement& element) {
  const Place place{file, element};
  std::size_t at = element.begin;
  if (element.properties.empty()) return at;
  const bool ascii = file.format == PlyFormat::kAscii;
  const std::size_t left = file.bytes.size() - at;  // a value in text needs at least a digit and a blank
  const std::size_t row_bytes = ascii ? 2 * element.properties.size() : least_row_bytes(element);
  if (std::uint64_t(element.count) > left / row_bytes)
    place.bad("element '" + printable(element.name) + "': " + std::to_string(left) + " bytes are left, expected " +
                  std::to_string(element.count) + " rows of " + (ascii || has_list(element) ? "at least " : "") +
                  std::to_string(row_bytes) + " bytes",
              "the file is cut short: copy or download it again");
  if (ascii) {
    for (std::int64_t i = 0; i < element.count; ++i) next_line(place, at, i);
    return at;
  }
  if (!has_list(element)) return at + std::size_t(element.count) * row_bytes;
  for (std::int64_t i = 0; i < element.count; ++i)
    at = scan_binary_row(place, at, i, [](std::size_t, const std::uint8_t*) {});
  return at;
}

PlyTable element_table(const PlyBytes& file, const PlyElement& element) {
  const Place place{file, element};
  PlyTable table;
  std::vector<PlyProperty> scalars;
  for (const PlyProperty& p : element.properties)
    if (!p.is_list) scalars.push_back(p);
  table.set_properties(std::move(scalars));
  table.rows = element.count;
  table.borrowed = file.bytes.data() + element.begin;
  if (table.row_bytes == 0 || table.rows == 0) return table;
  if (file.format == PlyFormat::kBinaryLittle && !has_list(element)) return table;

  table.owned.resize(std::size_t(table.rows) * table.row_bytes);
  std::size_t at = element.begin;
  for (std::int64_t i = 0; i < table.rows; ++i) {
    std::uint8_t* to = table.owned.data() + std::size_t(i) * table.row_bytes;
    if (file.format == PlyFormat::kAscii) {
      parse_line(place, next_line(place, at, i), i, to);
      continue;
    }
    at = scan_binary_row(place, at, i, [&](std::size_t p, const std::uint8_t* from) {
      load_little(file.format, element.properties[p].type, from, to);
      to += ply_type_bytes(element.properties[p].type);
    });
  }
  return table;
}

std::string printable(std::string_view word) {
  std::string text(word.substr(0, 60));
  for (char& c : text)
    if (c < 32 || c > 126) c = '?';
  return text;
}

}  // namespace ngs::io
