#pragma once
// Zip archives in memory.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct ZipEntry {
  std::string name;
  std::vector<std::uint8_t> bytes;
};

/// The entries of an archive, by name, each read when it is asked for.
class ZipReader {
 public:
  /// `name` is for messages; both outlive the reader. kBadInput where the bytes are no archive.
  ZipReader(const std::string& name, Bytes bytes);
  ~ZipReader();
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;

  /// Of the entries that are no folders, in the order of the archive.
  std::vector<std::string> names() const;

  /// kBadInput where there is no such entry, where it is damaged, and before any of it is read where it is longer than
  /// `most_bytes`. Entries may lie in a folder: the archive of a folder has its name before theirs.
  std::vector<std::uint8_t> read(const std::string& entry, std::size_t most_bytes) const;

 private:
  [[noreturn]] void bad(const std::string& message) const;

  const std::string& name_;
  struct Memory;
  Memory* memory_;
};

/// Entries are stored as they are, in order, dated 1980: the same entries give the same bytes.
std::vector<std::uint8_t> zip(const std::vector<ZipEntry>& entries);

}  // namespace ngs::io
