#pragma once
// Content hashes for the report: which bytes a result came from. XXH3 with 128 bits; not for security.
#include <cstdint>
#include <string>
#include <vector>

namespace ngs::io {

struct ContentHash {
  std::uint64_t bytes = 0;
  std::string xxh3;  // 32 hexadecimal digits, most significant first
};

/// Of a file's bytes; of a folder: of the names, sizes and hashes of all files under it in the order of their
/// names. Throws kBadInput if something cannot be read.
ContentHash content_hash(const std::string& path);

/// One for all of these files' bytes in this order, 32 digits; their names do not count, and what is no regular file
/// counts as absent.
std::string files_hash(const std::vector<std::string>& paths);

}  // namespace ngs::io
