#pragma once
// How wide a terminal shows a text, and where it may be cut: between code points. Combining marks take no column, East
// Asian wide characters and emoji two; a byte that is no UTF-8 takes one.
#include <string>
#include <string_view>

namespace ngs::cli {

int columns_of(std::string_view text);
/// The longest beginning of at most `columns` columns.
std::string_view first_columns(std::string_view text, int columns);
/// That, filled up with blanks.
std::string in_columns(std::string_view text, int columns);

}  // namespace ngs::cli
