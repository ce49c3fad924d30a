#include "shared/text/text_columns.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace ngs::cli {
namespace {

struct CodePoint {
  std::uint32_t value;
  std::size_t bytes;
};

/// The first code point of `text`, which is not empty; an invalid byte counts as one code point.
CodePoint first_of(std::string_view text) {
  const auto byte = [&](std::size_t i) { return std::uint8_t(text[i]); };
  const std::uint8_t lead = byte(0);
  const std::size_t bytes = lead >= 0xf0 && lead < 0xf8   ? 4
                            : lead >= 0xe0 && lead < 0xf0 ? 3
                            : lead >= 0xc0 && lead < 0xe0 ? 2
                                                          : 1;
  if (bytes > text.size()) return {lead, 1};
  std::uint32_t value = bytes == 1 ? lead : lead & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {lead, 1};
    value = value << 6 | (byte(i) & 0x3fu);
  }
  return {value, bytes};
}

struct Range {
  std::uint32_t first, last;
};
constexpr Range kNoColumn[] = {{0x300, 0x36f}, {0x200b, 0x200f}, {0x20d0, 0x20ff}, {0xfe00, 0xfe0f}, {0xfe20, 0xfe2f}};
constexpr Range kTwoColumns[] = {{0x1100, 0x115f}, {0x2e80, 0xa4cf},   {0xac00, 0xd7a3},
                                 {0xf900, 0xfaff}, {0xfe30, 0xfe6f},   {0xff00, 0xff60},
                                 {0xffe0, 0xffe6}, {0x1f300, 0x1faff}, {0x20000, 0x3fffd}};

template <std::size_t N>
bool is_in(const Range (&ranges)[N], std::uint32_t value) {
  for (const Range& r : ranges)
    if (value >= r.first && value <= r.last) return true;
  return false;
}

int columns_of(const CodePoint& point) {
  return is_in(kNoColumn, point.value) ? 0 : is_in(kTwoColumns, point.value) ? 2 : 1;
}

}  // namespace

int columns_of(std::string_view text) {
  int columns = 0;
  while (!text.empty()) {
    const CodePoint next = first_of(text);
    columns += columns_of(next);
    text.remove_prefix(next.bytes);
  }
  return columns;
}

std::string_view first_columns(std::string_view text, int columns) {
  std::size_t bytes = 0;
  while (bytes < text.size()) {
    const CodePoint next = first_of(text.substr(bytes));
    columns -= columns_of(next);
    if (columns < 0) break;
    bytes += next.bytes;
  }
  return text.substr(0, bytes);
}

std::string in_columns(std::string_view text, int columns) {
  const std::string_view fits = first_columns(text, columns);
  return std::string(fits).append(std::size_t(columns - columns_of(fits)), ' ');
}

std::string padded(std::string_view text, int columns) {
  return std::string(text).append(std::size_t(std::max(1, columns - columns_of(text))), ' ');
}

}  // namespace ngs::cli
