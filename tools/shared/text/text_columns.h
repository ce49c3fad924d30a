#pragma once
// Width of a text on a terminal. Texts are cut between code points. Combining marks take no column, East Asian wide
// characters and emoji two, an invalid UTF-8 byte one.
#include <string>
#include <string_view>

namespace ngs::cli {

int columns_of(std::string_view text);
/// The longest prefix of at most `columns` columns.
std::string_view first_columns(std::string_view text, int columns);
/// The same, padded with blanks.
std::string in_columns(std::string_view text, int columns);
/// The text padded with blanks, at least one; a longer text is not cut.
std::string padded(std::string_view text, int columns);

}  // namespace ngs::cli
