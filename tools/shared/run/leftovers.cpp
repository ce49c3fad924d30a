#include "shared/run/leftovers.h"

#include <filesystem>
#include <set>

namespace ngs::cli {

namespace fs = std::filesystem;

Leftovers::Leftovers(std::string folder) : folder_(std::move(folder)), before_(files_in(folder_)) {}

std::map<std::string, os::FileVersion> Leftovers::files_in(const std::string& folder) {
  std::map<std::string, os::FileVersion> files;
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const os::FileVersion version = os::version_of_file(entry->path().generic_string());
    if (version.inode != 0) files[entry->path().lexically_relative(folder).generic_string()] = version;
  }
  return files;
}

std::vector<std::string> Leftovers::untouched() const {
  if (before_.empty()) return {};
  const std::map<std::string, os::FileVersion> now = files_in(folder_);
  const auto is_old = [&](const std::string& name) {
    const auto old = before_.find(name), found = now.find(name);
    return old != before_.end() && found != now.end() && old->second == found->second;
  };
  std::set<fs::path> kinds;  // extensions that the run has written
  for (const auto& [name, file] : now)
    if (!is_old(name)) kinds.insert(fs::path(name).extension());
  std::vector<std::string> names;
  for (const auto& [name, file] : before_)
    if (is_old(name) && kinds.contains(fs::path(name).extension())) names.push_back(name);
  return names;
}

}  // namespace ngs::cli
