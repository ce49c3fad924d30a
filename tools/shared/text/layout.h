#pragma once
// Texts for a terminal: in lines of its width, with hanging indents.
#include <string>
#include <string_view>
#include <vector>

namespace ngs::cli {

/// COLUMNS, else the columns of the terminal that this descriptor is, else 100; in [40, 120].
int terminal_columns(int descriptor = 1);

struct Margins {
  int indent;                        // of all lines but the first
  int width;                         // of all lines
  std::string_view break_mark = {};  // at the end of every line but the last, such as " \\"
};

/// `text`, cut between words, behind `start`, the beginning of its first line. A word that fits on no line is cut
/// behind
/// '|', ',' or '/', else anywhere. No newline at the end.
std::string wrapped(std::string start, std::string_view text, const Margins& margins);

/// Lines that are there already, each cut where it is too wide; what comes over is indented as its line, or stands
/// under the last of its columns, two blanks apart, that leaves a third of the width.
std::string rewrapped(std::string_view lines, int width);

}  // namespace ngs::cli
