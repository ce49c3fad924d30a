#pragma once
// An input file as read-only bytes. A regular file is memory-mapped: its pages are loaded on first access and use no
// heap. A pipe is read to its end. Renaming an output over the path does not change the mapping; if another program
// truncates a mapped file in place, readers get SIGBUS (ngs itself never does that).
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ngs/os/input_file.h"

namespace ngs::io {

using Bytes = std::span<const std::uint8_t>;

inline constexpr const char* kDevice = "a device, expected a file";  // why it cannot be read

class MappedFile {
 public:
  MappedFile() = default;  // no bytes
  /// Throws kBadInput with the reason.
  explicit MappedFile(const std::string& path);
  /// Bytes that are already in memory, such as those of an unpacked archive.
  explicit MappedFile(std::vector<std::uint8_t> bytes) { bytes_.read = std::move(bytes); }
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept { swap(other); }
  MappedFile& operator=(MappedFile&& other) noexcept {
    swap(other);
    return *this;
  }

  Bytes bytes() const { return bytes_.map != nullptr ? Bytes(bytes_.map, bytes_.map_bytes) : Bytes(bytes_.read); }
  /// Releases the pages that have been loaded; a later access loads them again.
  void forget_pages() const;
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes().data()), bytes().size()}; }

 private:
  void swap(MappedFile& other) noexcept;

  os::FileBytes bytes_;
};

// Files whose paths come from other files. Unlike a user's argument, such a path may be unsafe to open: a pipe would
// block, a device would never end.
bool is_regular_file(const std::string& path);

/// Throws kBadInput if `path` exists and is not a regular file. A missing file is reported when it is opened.
void require_regular_file(const std::string& path);

/// Throws kBadInput unless `path` is a readable regular file.
MappedFile map_regular_file(const std::string& path);

}  // namespace ngs::io
