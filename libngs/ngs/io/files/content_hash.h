#pragma once
// Content hashes that identify inputs in reports. XXH3 with 128 bits; not cryptographic.
#include <cstdint>
#include <string>
#include <vector>

namespace ngs::io {

struct ContentHash {
  std::uint64_t bytes = 0;
  std::string xxh3;  // 32 hexadecimal digits, most significant first
};

/// Hash of a file's bytes, or of the names, sizes and hashes of all files under a folder in the order of their names.
/// Throws kBadInput if something cannot be read.
ContentHash content_hash(const std::string& path);

/// One hash, 32 digits, over the bytes of these files in this order. File names do not matter; a path that is not a
/// regular file counts as absent.
std::string files_hash(const std::vector<std::string>& paths);

}  // namespace ngs::io
