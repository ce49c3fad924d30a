#pragma once
// Zip archives in memory.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct ZipEntry {
  std::string name;
  std::vector<std::uint8_t> bytes;
};

class ZipReader {
 public:
  /// `name` is for messages; both must outlive the reader. kBadInput if the bytes are not an archive.
  ZipReader(const std::string& name, Bytes bytes);
  ~ZipReader();
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;

  /// Names of the entries that are not folders, in archive order.
  std::vector<std::string> names() const;

  /// kBadInput if there is no such entry, if it is damaged, or if it is longer than `max_bytes` (checked before it is
  /// read). Matches `entry` at the end of the path, so
  /// archives of a folder work too.
  std::vector<std::uint8_t> read(const std::string& entry, std::size_t max_bytes) const;

 private:
  [[noreturn]] void fail(const std::string& message) const;

  struct Impl;
  const std::string& name_;
  std::unique_ptr<Impl> impl_;
};

/// Entries are stored uncompressed, in order, dated 1980: equal entries give equal bytes.
std::vector<std::uint8_t> zip(const std::vector<ZipEntry>& entries);

}  // namespace ngs::io
