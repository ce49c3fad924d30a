#pragma once
// Gzip streams.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

/// Inflates a gzip stream piece by piece, so that a header can be checked before memory is allocated for its data.
class GunzipReader {
 public:
  /// `name` is for messages; both must outlive the reader.
  GunzipReader(const std::string& name, Bytes stream);
  ~GunzipReader();
  GunzipReader(const GunzipReader&) = delete;
  GunzipReader& operator=(const GunzipReader&) = delete;

  /// The next bytes.size() bytes. kBadInput if the stream ends earlier or is not gzip.
  void read(std::span<std::uint8_t> bytes);
  /// All remaining bytes; verifies the checksum. kBadInput for more than `max_bytes`, and as read().
  std::vector<std::uint8_t> read_all(std::size_t max_bytes);
  /// Skips at most 1 MiB of trailing data and verifies the checksum. kBadInput if it is wrong.
  void finish();

 private:
  int inflate_some(std::span<std::uint8_t> to, std::size_t& done);
  [[noreturn]] void refuse(int status, std::size_t missing) const;

  struct State;
  const std::string& name_;
  State* state_;
};

/// One member without time stamp and name: equal bytes give equal streams.
std::vector<std::uint8_t> gzip(Bytes bytes);

// Zstandard frames of known size.

/// Fills `out` from `frames`. kBadInput, with `object` in the message, if they hold more or fewer bytes than `out`.
void unzstd(const std::string& object, Bytes frames, std::span<std::uint8_t> out);

}  // namespace ngs::io
