#include "shared/text/layout.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "shared/os/terminal.h"
#include "shared/text/text_columns.h"

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

}  // namespace ngs::cli
