#include "shared/text/layout.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "shared/os/machine.h"

namespace ngs::cli {
namespace {

constexpr int kFewestColumns = 40, kMaxColumns = 120, kColumnsOfNoTerminal = 100;

/// Where to break a word wider than `columns`, in bytes.
std::size_t cut_of(std::string_view word, int columns) {
  const std::string_view fits = first_columns(word, columns);
  const std::size_t seam = fits.find_last_of("|,/");
  return std::max<std::size_t>(1, seam == fits.npos ? fits.size() : seam + 1);
}

class Lines {
 public:
  Lines(std::string start, const Margins& margins)
      : text_(std::move(start)), column_(columns_of(text_)), margins_(margins) {
    is_open_ = text_.empty() || text_.back() == ' ';
  }
  void add(std::string_view word) {
    const int room = margins_.width - margins_.indent - columns_of(margins_.break_mark);
    while (columns_of(word) > room && room > 0) {
      const std::size_t cut = cut_of(word, room);
      put(word.substr(0, cut));
      is_open_ = true;
      word.remove_prefix(cut);
    }
    put(word);
  }
  std::string take() { return std::move(text_); }

 private:
  void put(std::string_view word) {
    const int columns = columns_of(word), blank = is_open_ ? 0 : 1;
    if (column_ + blank + columns + columns_of(margins_.break_mark) > margins_.width && column_ > margins_.indent) {
      while (!text_.empty() && text_.back() == ' ') text_.pop_back();
      (text_ += margins_.break_mark) += "\n" + std::string(std::size_t(margins_.indent), ' ');
      column_ = margins_.indent;
    } else {
      text_.append(std::size_t(blank), ' ');
      column_ += blank;
    }
    text_ += word;
    column_ += columns;
    is_open_ = false;
  }

  std::string text_;
  int column_;
  bool is_open_;  // the next word follows without a blank
  Margins margins_;
};

/// Start of the last column that leaves a third of the width, else of the first word.
std::size_t hanging_indent(std::string_view line, std::size_t width) {
  const std::size_t most = 2 * width / 3, gap = line.rfind("  ", most);
  const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t last = gap == line.npos ? first : line.find_first_not_of(' ', gap);
  return last > most ? first : last;
}

}  // namespace

int terminal_columns(int descriptor) {
  int columns = 0;
  if (const char* text = std::getenv("COLUMNS")) std::from_chars(text, text + std::strlen(text), columns);
  if (columns <= 0) columns = os::terminal_width(descriptor);
  return columns <= 0 ? kColumnsOfNoTerminal : std::clamp(columns, kFewestColumns, kMaxColumns);
}

std::string wrapped(std::string start, std::string_view text, const Margins& margins) {
  Lines lines(std::move(start), margins);
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (text.empty()) return lines.take();
    const std::size_t end = std::min(text.find(' '), text.size());
    lines.add(text.substr(0, end));
    text.remove_prefix(end);
  }
}

std::string rewrapped(std::string_view lines, int width) {
  std::string text;
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    const std::string_view line = lines.substr(0, end);
    if (columns_of(line) <= width) {
      text += line;
    } else {
      const std::size_t indent = hanging_indent(line, std::size_t(width));
      text += wrapped(std::string(line.substr(0, indent)), line.substr(indent), {int(indent), width});
    }
    text += '\n';
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return text;
}

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

std::string read_text_file(const std::string& path, ErrorCode code) {
  constexpr std::uintmax_t kMaxBytes = 64u << 20;
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
  if (failed) throw Error(code, path + ": " + failed.message() + ", expected a file");
  if (bytes > kMaxBytes) throw Error(code, path + ": " + std::to_string(bytes) + " bytes, expected at most 64 MiB");
  std::ifstream file(path, std::ios::binary);
  std::string text(bytes, '\0');
  if (!file.read(text.data(), std::streamsize(bytes))) throw Error(code, path + ": cannot be read");
  return text;
}

}  // namespace ngs::cli
