#include "shared/text/text_file.h"

#include <filesystem>
#include <fstream>

namespace ngs::cli {

std::string read_text_file(const std::string& path, ErrorCode code) {
  constexpr std::uintmax_t kMaxBytes = 64u << 20;
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
  if (failed) throw Error(code, path + ": " + failed.message() + ", expected a file");
  if (bytes > kMaxBytes) throw Error(code, path + ": " + std::to_string(bytes) + " bytes, expected at most 64 MiB");
  std::ifstream file(path, std::ios::binary);
  std::string text(bytes, '\0');
  if (!file.read(text.data(), std::streamsize(bytes))) throw Error(code, path + ": cannot be read");
  return text;
}

}  // namespace ngs::cli
