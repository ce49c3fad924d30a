#include "shared/run/sibling_program.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/shell_word.h"
#include "shared/os/files.h"
#include "shared/os/machine.h"

namespace ngs::cli {

namespace fs = std::filesystem;

std::vector<std::string> sibling_command(std::vector<std::string> words) {
  const fs::path self = os::path_of_this_program();
  const int unknown = self.empty() ? errno : 0;
  const std::string program = words[0];
  words[0] = (self.parent_path() / program).generic_string() + (self.extension() == ".exe" ? ".exe" : "");
  if (unknown != 0 || !os::is_executable(words[0]))
    throw Error(ErrorCode::kEnvironment,
                words[0] + ": " + std::strerror(unknown != 0 ? unknown : errno) + ", expected the program " + program +
                    " next to " + self.filename().string(),
                "install all tools into one folder");
  return words;
}

std::string quoted_line(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + io::shell_word(word);
  return text;
}

}  // namespace ngs::cli
