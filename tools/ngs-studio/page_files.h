#pragma once
// The page, as it was when the tool was built: nothing is looked up when a browser asks.
#include <string_view>
#include <vector>

namespace ngs::studio {

struct PageFile {
  std::string_view path;  // "/studio.js"
  std::string_view bytes;
};
const std::vector<PageFile>& page_files();

}  // namespace ngs::studio
