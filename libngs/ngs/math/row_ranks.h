#pragma once
// The rank of each number in a set, without sorting the set.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ngs {

/// A set of numbers below `limit`, as a bit set.
class RowRanks {
 public:
  explicit RowRanks(std::int64_t limit) : bits_(std::size_t(limit + 63) / 64), before_(bits_.size()) {}

  /// Adds rows; call count() after the last add().
  void add(std::span<const std::uint32_t> rows) {
    for (const std::uint32_t row : rows) bits_[row / 64] |= std::uint64_t(1) << row % 64;
  }
  void count() {
    std::uint32_t sum = 0;
    for (std::size_t word = 0; word < bits_.size(); ++word) {
      before_[word] = sum;
      sum += std::uint32_t(std::popcount(bits_[word]));
    }
  }
  /// How many numbers of the set are smaller; after count().
  std::size_t of(std::uint32_t row) const {
    const std::uint64_t smaller = bits_[row / 64] & ((std::uint64_t(1) << row % 64) - 1);
    return before_[row / 64] + std::size_t(std::popcount(smaller));
  }

 private:
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> before_;  // numbers before a word
};

}  // namespace ngs
