#pragma once
// A whole input as read-only bytes. A regular file is mapped (its pages are read when they are touched and
// cost no heap); a pipe is read to its end. An output renamed over the path leaves the mapping as it was; a
// program that shortens a mapped file in place ends its readers (SIGBUS), which ngs itself never does.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ngs::io {

using Bytes = std::span<const std::uint8_t>;

class MappedFile {
 public:
  MappedFile() = default;  // no bytes
  /// Throws kBadInput with the reason.
  explicit MappedFile(const std::string& path);
  /// Bytes that are in memory already, such as those of an unpacked archive.
  explicit MappedFile(std::vector<std::uint8_t> bytes) : read_(std::move(bytes)) {}
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept { swap(other); }
  MappedFile& operator=(MappedFile&& other) noexcept {
    swap(other);
    return *this;
  }

  Bytes bytes() const { return map_ != nullptr ? Bytes(map_, map_bytes_) : Bytes(read_); }
  /// Gives the pages read so far back to the system; reading them again fetches them again.
  void forget_pages() const;
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes().data()), bytes().size()}; }

 private:
  void swap(MappedFile& other) noexcept;

  const std::uint8_t* map_ = nullptr;
  std::size_t map_bytes_ = 0;
  std::vector<std::uint8_t> read_;
};

}  // namespace ngs::io
