#pragma once
// The source files of the project, for tests of the code rules.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "support/temp_dir.h"

namespace ngs::test {

struct SourceFile {
  std::string path;  // relative to the project root, "libngs/ngs/ops/field/rbf.cpp"
  std::string text;
  bool ends_with(const std::string& suffix) const {
    return path.size() >= suffix.size() && path.compare(path.size() - suffix.size(), suffix.size(), suffix) == 0;
  }
  bool in(const std::string& folder) const { return path.rfind(folder + "/", 0) == 0; }
};

inline SourceFile source_file(const std::string& path) { return {path, read_bytes(NGS_SOURCE_DIR "/" + path)}; }

/// Files under the named folders whose names end with one of `suffixes`, sorted by path; files installed by npm are
/// skipped.
inline std::vector<SourceFile> source_files(const std::vector<std::string>& folders,
                                            const std::vector<std::string>& suffixes) {
  namespace fs = std::filesystem;
  std::vector<SourceFile> files;
  for (const std::string& folder : folders)
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(NGS_SOURCE_DIR) / folder)) {
      SourceFile file{entry.path().lexically_relative(NGS_SOURCE_DIR).generic_string(), {}};
      const bool wanted =
          std::any_of(suffixes.begin(), suffixes.end(), [&](const std::string& s) { return file.ends_with(s); });
      if (!wanted || !entry.is_regular_file() || file.path.find("/node_modules/") != std::string::npos) continue;
      file.text = read_bytes(entry.path().string());
      files.push_back(std::move(file));
    }
  std::sort(files.begin(), files.end(), [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return files;
}

inline std::vector<SourceFile> code_files() { return source_files({"libngs", "tools"}, {".h", ".cpp", ".cu", ".cuh"}); }

/// `offenders`, one per line; empty if the rule holds.
inline std::string listed(const std::vector<std::string>& offenders) {
  std::string text;
  for (const std::string& offender : offenders) text += offender + "\n";
  return text;
}

}  // namespace ngs::test
