#pragma once
// Texts that people edit.
#include <string>
#include <string_view>
#include <vector>

namespace ngs::io {

/// The text behind the byte order mark that some editors put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

/// The lines of a list of names without the blanks around them; empty ones and those that begin with '#' are left out.
/// Throws kBadInput.
std::vector<std::string> read_name_list(const std::string& path);

}  // namespace ngs::io
