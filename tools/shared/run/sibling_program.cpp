#include "shared/run/sibling_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/shell_word.h"

namespace ngs::cli {

namespace fs = std::filesystem;

std::string sibling_path(const std::string& program) {
  std::error_code unknown;
  const fs::path self = fs::read_symlink("/proc/self/exe", unknown);
  const std::string path = (self.parent_path() / program).string();
  if (unknown || access(path.c_str(), X_OK) != 0)
    throw Error(ErrorCode::kEnvironment,
                path + ": " + (unknown ? unknown.message() : std::strerror(errno)) + ", expected the program " +
                    program + " next to " + self.filename().string(),
                "install all tools into one folder");
  return path;
}

std::string quoted_line(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + io::shell_word(word);
  return text;
}

}  // namespace ngs::cli
