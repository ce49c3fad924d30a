#include "ngs/io/files/text_lines.h"

#include <algorithm>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

std::vector<std::string> read_name_list(const std::string& path) {
  constexpr std::string_view kBlank = " \t\r";
  const MappedFile file(path);
  std::vector<std::string> names;
  for (std::string_view rest = without_byte_order_mark(file.text()); !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    line = line.substr(0, line.find_last_not_of(kBlank) + 1);
    if (!line.empty() && line[0] != '#') names.emplace_back(line);
  }
  return names;
}

}  // namespace ngs::io
