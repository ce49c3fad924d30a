#pragma once
// Reads little-endian values from untrusted bytes: every read is checked against the end.
#include <bit>
#include <cstring>
#include <string>

#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

static_assert(std::endian::native == std::endian::little);

class ByteReader {
 public:
  ByteReader(Bytes bytes, std::string object) : bytes_(bytes), object_(std::move(object)) {}

  template <class T>
  T read() {
    need(sizeof(T));
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }

  /// The characters up to a NUL, which is consumed.
  std::string read_name() {
    const void* end = std::memchr(bytes_.data() + at_, 0, left());
    if (left() == 0 || end == nullptr) truncated();
    const std::size_t length = std::size_t(static_cast<const std::uint8_t*>(end) - (bytes_.data() + at_));
    std::string name(reinterpret_cast<const char*>(bytes_.data()) + at_, length);
    at_ += length + 1;
    return name;
  }

  /// Reads a count of records of at least `min_bytes` each. kBadInput if the remaining bytes cannot hold that many.
  std::uint64_t read_count(std::size_t min_bytes) {
    const auto count = read<std::uint64_t>();
    if (count > left() / min_bytes)
      throw Error(ErrorCode::kBadInput,
                  object_ + ": count of " + std::to_string(count) + " records at byte " + std::to_string(at_ - 8) +
                      ", expected at most " + std::to_string(left() / min_bytes) + " for the size of the file",
                  "the file is truncated or of another format");
    return count;
  }

  void skip(std::uint64_t bytes) {
    need(bytes);
    at_ += std::size_t(bytes);
  }
  std::size_t left() const { return bytes_.size() - at_; }
  const std::string& object() const { return object_; }

 private:
  void need(std::uint64_t bytes) const {
    if (bytes > left()) truncated();
  }
  [[noreturn]] void truncated() const {
    throw Error(
        ErrorCode::kBadInput,
        object_ + ": ends at byte " + std::to_string(bytes_.size()) + " inside a record, expected a complete file",
        "copy or export it again");
  }

  Bytes bytes_;
  std::string object_;
  std::size_t at_ = 0;
};

}  // namespace ngs::io
