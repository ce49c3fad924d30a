#pragma once
// Files of the page, embedded at build time: requests never touch the file system.
#include <string_view>
#include <vector>

namespace ngs::studio {

struct PageFile {
  std::string_view path;  // "/studio.js"
  std::string_view bytes;
};
const std::vector<PageFile>& page_files();

}  // namespace ngs::studio
