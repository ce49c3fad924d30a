#pragma once
// One of N parts of some work, given as "i/N" with 0 <= i < N.
#include <cstddef>
#include <string>

namespace ngs::cli {

struct Shard {
  std::size_t index = 0, count = 1;
};

/// Throws kUsage for any other text, or for more than 2^20 parts. `option` ("--views") is for the message.
Shard parse_shard(const std::string& option, const std::string& text);

}  // namespace ngs::cli
