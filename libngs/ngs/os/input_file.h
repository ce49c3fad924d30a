#pragma once
// Bytes of a file to read: mapped if it is a regular file, else read to its end.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ngs::os {

struct FileBytes {
  const std::uint8_t* map = nullptr;  // of a regular file that is not empty
  std::size_t map_bytes = 0;
  std::vector<std::uint8_t> read;
};

/// Whether a path is a pipe or socket, whose bytes can be read only once.
bool is_pipe(const std::string& path);
/// Whether a path is a device, whose bytes may never end: not /dev/null, which is empty.
bool is_device(const std::string& path);
/// 0, or the errno that tells why the file cannot be read (EISDIR: it is a folder; ENODEV: a device; EPIPE: a named
/// pipe into which no program writes, after 10 s).
int load_file(const std::string& path, FileBytes& bytes);
void unmap_file(const FileBytes& bytes);
/// Releases the loaded pages of the map; a later access loads them again.
void forget_pages(const FileBytes& bytes);
/// The path by which load_file() reads the standard input.
const char* path_of_stdin();

}  // namespace ngs::os
