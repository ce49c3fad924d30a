#pragma once
// Descriptors of files to write, and what the system offers to make an output appear at once. Functions that fail
// return -1 or false and set errno.
#include <cstddef>
#include <cstdint>
#include <string>

namespace ngs::os {

enum class PathKind { kNothing, kRegular, kFolder, kOther };  // kOther: a pipe, a device
/// Follows symbolic links.
PathKind kind_of_path(const std::string& path);

int process_id();
/// Creates a file that must not exist (EEXIST).
int create_file(const std::string& path);
/// Opens an existing file, pipe or device for writing.
int open_to_write(const std::string& path);
/// Returns how many bytes were written.
std::int64_t write_some(int descriptor, const void* data, std::size_t bytes);
/// Starts the write-back of a range to the disk, where the system can.
void start_write_back(int descriptor, std::int64_t offset, std::int64_t bytes);
bool sync_file(int descriptor);
/// Renames a file that `descriptor` has open to `target`, which is replaced. Closes the descriptor, also on failure.
bool replace_file(int descriptor, const std::string& path, const std::string& target);
void close_file(int descriptor);
/// Both are async-signal-safe.
void remove_file(const char* path) noexcept;
void remove_folder(const char* path) noexcept;

}  // namespace ngs::os
