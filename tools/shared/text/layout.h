#pragma once
// Wraps texts to the width of a terminal, with hanging indents.
#include <string>
#include <string_view>

#include "ngs/core/error.h"

namespace ngs::cli {

/// COLUMNS, else the columns of the terminal behind this descriptor, else 100; clamped to [40, 120].
int terminal_columns(int descriptor = 1);

struct Margins {
  int indent;                        // of all lines except the first
  int width;                         // of all lines
  std::string_view break_mark = {};  // at the end of every line but the last, such as " \\"
};

/// `start` followed by `text`, wrapped between words. A word longer than a line is broken after '|', ',' or '/', else
/// anywhere. The result has no final newline.
std::string wrapped(std::string start, std::string_view text, const Margins& margins);

/// Wraps each line of `lines` that is too wide. A continuation has the indent of its line, or starts at the last of its
/// columns (separated by two blanks) that leaves a third of the width.
std::string rewrapped(std::string_view lines, int width);

// Width of a text on a terminal. Texts are cut between code points. Combining marks take no column, East Asian wide
// characters and emoji two, an invalid UTF-8 byte one.
int columns_of(std::string_view text);
/// The longest prefix of at most `columns` columns.
std::string_view first_columns(std::string_view text, int columns);
/// The same, padded with blanks.
std::string in_columns(std::string_view text, int columns);
/// The text padded with blanks, at least one; a longer text is not cut.
std::string padded(std::string_view text, int columns);

// Reads small text files completely.

/// The bytes of a file of at most 64 MiB. Throws `code` if it cannot be read.
std::string read_text_file(const std::string& path, ErrorCode code);

}  // namespace ngs::cli
