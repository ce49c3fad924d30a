#pragma once
// Paths stored in files, relative to the folder of the file that contains them.
#include <cstdint>
#include <filesystem>
#include <string>

namespace ngs::io {

/// Makes a path stored in a file of `folder` relative to the working directory. Absolute and empty paths do not change.
std::string path_from_folder(const std::string& folder, const std::string& path);

/// The folder to which relative paths in `file` refer: its own, or the working directory (empty) if the file is a pipe.
std::string folder_of_file(const std::string& file);

/// The folder of a file, for path_to_folder(). Default-constructed (for pipes), stored paths are absolute.
struct FileFolder {
  FileFolder() = default;
  explicit FileFolder(const std::string& file);
  std::filesystem::path named, real;  // absolute; as given by the user, and with symbolic links resolved
};

enum class StoredPaths : std::uint8_t { kRelative, kAbsolute };  // kAbsolute: the file's final folder is unknown
/// The folder to which the paths stored in `file` are relative.
inline FileFolder stored_folder(const std::string& file, StoredPaths stored) {
  return stored == StoredPaths::kAbsolute ? FileFolder() : FileFolder(file);
}

/// Converts `path`, relative to the working directory, to one relative to `folder`. Paths below `folder` keep their
/// names, so that the folder can be moved together with its symbolic links. For all other paths the links of the parent
/// folders are resolved, because ".." after a link leads elsewhere; the file's own name is kept.
std::string path_to_folder(const FileFolder& folder, const std::string& path);

}  // namespace ngs::io
