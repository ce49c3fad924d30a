#pragma once
// Files of the viewer's page, embedded at build time.
#include <string_view>
#include <vector>

namespace ngs::cli {

struct PageFile {
  std::string_view path;  // "/viewer.js"
  std::string_view bytes;
};
const std::vector<PageFile>& page_files();

}  // namespace ngs::cli
