#include "shared/scene/shard.h"

#include <charconv>

#include "ngs/core/error.h"

namespace ngs::cli {

Shard parse_shard(const std::string& option, const std::string& text) {
  Shard shard{0, 0};
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, shard.index);
  const bool slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, shard.count) : first;
  if (!slash || second.ec != std::errc() || second.ptr != end || shard.index >= shard.count || shard.count > 1u << 20)
    throw Error(ErrorCode::kUsage, option + ": '" + text + "', expected i/N with 0 <= i < N",
                "for example " + option + " 0/8");
  return shard;
}

}  // namespace ngs::cli
