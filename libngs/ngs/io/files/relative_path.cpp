#include "ngs/io/files/relative_path.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

bool leads_out(const fs::path& relative) { return relative.empty() || *relative.begin() == ".."; }

/// After a symbolic link ".." leads to the parent of the link's target, not of the link.
bool is_behind_a_link(const fs::path& folder) {
  std::error_code failed;
  const fs::path named = fs::absolute(folder, failed), real = fs::weakly_canonical(named, failed);
  return !failed && (named / "").lexically_normal() != real / "";
}

/// Whether `file` is a pipe, or bytes in memory read from one: no folder contains it.
bool lies_nowhere(const std::string& file) {
  std::error_code failed;
  const fs::file_status status = fs::status(file, failed);
  return fs::exists(status) && (!fs::is_regular_file(status) || fs::hard_link_count(file, failed) == 0);
}

}  // namespace

std::string path_from_folder(const std::string& folder, const std::string& path) {
  if (path.empty() || folder.empty()) return path;
  const fs::path joined = fs::path(folder) / path;
  if (leads_out(fs::path(path).lexically_normal()) && is_behind_a_link(folder)) return joined.generic_string();
  return joined.lexically_normal().generic_string();
}

std::string folder_of_file(const std::string& file) {
  return lies_nowhere(file) ? std::string() : fs::path(file).parent_path().generic_string();
}

FileFolder::FileFolder(const std::string& file)
    : named(fs::absolute(file).lexically_normal().parent_path()),
      real(fs::weakly_canonical(fs::absolute(file).parent_path())) {}

std::string path_to_folder(const FileFolder& folder, const std::string& path) {
  if (path.empty()) return path;
  const fs::path absolute = fs::absolute(path).lexically_normal();
  if (folder.named.empty()) return absolute.generic_string();
  if (const fs::path below = absolute.lexically_relative(folder.named); !leads_out(below))
    return below.generic_string();
  const fs::path relative =
      (fs::weakly_canonical(absolute.parent_path()) / absolute.filename()).lexically_relative(folder.real);
  return relative.empty() ? absolute.generic_string() : relative.generic_string();
}

}  // namespace ngs::io
