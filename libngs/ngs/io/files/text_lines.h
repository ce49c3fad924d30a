#pragma once
// Text files that people edit.
#include <string>
#include <string_view>
#include <vector>

namespace ngs::io {

/// The text after the byte order mark that some editors put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

/// The lines of a name list, trimmed; empty lines and lines that begin with '#' are skipped. Throws kBadInput.
std::vector<std::string> read_name_list(const std::string& path);

}  // namespace ngs::io
