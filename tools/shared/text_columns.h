#pragma once
// Names in tables for people: how wide a terminal shows them, and where they may be cut.
#include <string>
#include <string_view>

namespace ngs::cli {

/// `text` cut to at most `columns` columns of a terminal, between code points, and filled up with blanks. Combining marks
/// take no column, East Asian wide characters and emoji two; a byte that is no UTF-8 takes one.
std::string in_columns(std::string_view text, int columns);

}  // namespace ngs::cli
