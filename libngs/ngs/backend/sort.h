#pragma once
// Stable sort by an unsigned key. Equal keys keep their order, so that results are defined down to the bit.
#include <cstdint>
#include <vector>

namespace ngs {

/// Permutation `order` with key[order[0]] <= key[order[1]] <= ...; equal keys in index order. LSD radix, 11 bits
/// a pass; a pass in which all keys share their digit is skipped.
inline std::vector<std::uint32_t> stable_order(const std::vector<std::uint32_t>& key) {
  constexpr int kBits = 11;
  constexpr std::uint32_t kBuckets = 1u << kBits;
  const std::size_t n = key.size();
  std::vector<std::uint32_t> order(n), scratch(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = std::uint32_t(i);
  for (int shift = 0; shift < 32; shift += kBits) {
    std::vector<std::uint32_t> begin(kBuckets + 1, 0);
    for (const std::uint32_t k : key) ++begin[((k >> shift) & (kBuckets - 1)) + 1];
    bool trivial = false;
    for (std::uint32_t b = 0; b < kBuckets; ++b) {
      trivial |= begin[b + 1] == n;
      begin[b + 1] += begin[b];
    }
    if (trivial) continue;
    for (const std::uint32_t i : order) scratch[begin[(key[i] >> shift) & (kBuckets - 1)]++] = i;
    order.swap(scratch);
  }
  return order;
}

}  // namespace ngs
