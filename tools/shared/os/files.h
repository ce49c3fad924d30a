#pragma once
// Files, beyond reading and writing (ngs/os/). Functions that fail return -1, false or an empty path, and set errno.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace ngs::os {

bool is_readable(const std::string& path);
bool is_executable(const std::string& path);
/// Whether the umask lets the owner read and write the files and folders that this process creates.
bool owner_keeps_rights();

/// Tells whether a file was replaced or rewritten.
struct FileVersion {
  std::uint64_t inode = 0;  // 0: not a regular file
  std::int64_t written_ns = 0;
  bool operator==(const FileVersion&) const = default;
};
FileVersion version_of_file(const std::string& path);

/// A path in TMPDIR, or in /tmp if TMPDIR is not a folder.
inline std::string temporary_path(const char* name) {
  std::error_code absent;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(absent);
  return ((absent ? std::filesystem::path("/tmp") : folder) / name).generic_string();
}

/// `path` ends in XXXXXX, which is replaced.
bool make_temporary_file(std::string& path);
bool make_temporary_folder(std::string& path);
/// The path of a file with these bytes, which exists until the process ends.
std::string file_of_bytes(std::string_view bytes);

/// The descriptor of a new unnamed file; it vanishes when its descriptor is closed. All writes append.
int unnamed_file(std::string path);
/// Locks a folder until the returned descriptor is closed or this process ends in any way. Returns -1 on failure: with
/// EWOULDBLOCK the folder is already locked; with another error the system has no locks.
int lock_folder(const std::string& folder);
void unlock_folder(int descriptor);
/// Returns how many bytes were read; concurrent writes are not disturbed.
std::int64_t read_at(int descriptor, void* to, std::size_t bytes, std::int64_t offset);
std::int64_t size_of_file(int descriptor);

}  // namespace ngs::os
