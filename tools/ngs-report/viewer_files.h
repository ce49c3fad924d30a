#pragma once
// What the viewer's page is made of, as it was when the tool was built.
#include <string_view>
#include <vector>

namespace ngs::cli {

struct PageFile {
  std::string_view path;  // "/viewer.js"
  std::string_view bytes;
};
const std::vector<PageFile>& page_files();

}  // namespace ngs::cli
