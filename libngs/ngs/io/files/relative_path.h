#pragma once
// Paths in files, relative to the folder of the file that holds them.
#include <cstdint>
#include <filesystem>
#include <string>

namespace ngs::io {

/// A path of a file in `folder` as the working directory sees it. Absolute and empty paths stay as they are.
std::string path_from_folder(const std::string& folder, const std::string& path);

/// What the relative paths of a file start from: its folder, or the working directory (empty) where the file came
/// through a pipe and lies nowhere.
std::string folder_of_file(const std::string& file);

/// The folder that a file lies in, for path_to_folder. Without one, for what goes through a pipe, paths are absolute.
struct FileFolder {
  FileFolder() = default;
  explicit FileFolder(const std::string& file);
  std::filesystem::path named, real;  // absolute; as the user names it, and with its links resolved
};

enum class StoredPaths : std::uint8_t { kRelative, kAbsolute };  // absolute: for what will lie nobody knows where
/// What the paths stored in `file` are relative to.
inline FileFolder stored_folder(const std::string& file, StoredPaths stored) {
  return stored == StoredPaths::kAbsolute ? FileFolder() : FileFolder(file);
}

/// `path`, which the working directory sees, relative to the folder. What lies below the folder by name keeps its
/// name, so that the folder can be moved with the links in it; for all else the links of the folders are resolved, or
/// ".." would lead elsewhere (the file's own name is kept).
std::string path_to_folder(const FileFolder& folder, const std::string& path);

}  // namespace ngs::io
