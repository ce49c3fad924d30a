#pragma once
// Gzip streams.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

/// Inflates a gzip stream piece by piece, so that a header can be looked at before memory is taken for what it claims.
class GunzipReader {
 public:
  /// `name` is for messages; both outlive the reader.
  GunzipReader(const std::string& name, Bytes stream);
  ~GunzipReader();
  GunzipReader(const GunzipReader&) = delete;
  GunzipReader& operator=(const GunzipReader&) = delete;

  /// The next bytes.size() bytes. kBadInput where the stream ends before, or is none.
  void read(std::span<std::uint8_t> bytes);
  /// All that is left, with its checksum. kBadInput where that is more than `most_bytes`, and as read().
  std::vector<std::uint8_t> read_all(std::size_t most_bytes);
  /// Looks at what is behind: at most 1 MiB, which is ignored, then the checksum. kBadInput where it is wrong.
  void finish();

 private:
  int inflate_some(std::span<std::uint8_t> to, std::size_t& done);
  [[noreturn]] void refuse(int status, std::size_t missing) const;

  struct State;
  const std::string& name_;
  State* state_;
};

/// One member without a time or a name: the same bytes give the same stream.
std::vector<std::uint8_t> gzip(Bytes bytes);

}  // namespace ngs::io
