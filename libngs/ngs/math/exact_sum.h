#pragma once
// Sums of non-negative numbers in 128-bit fixed point (64 integer bits, 64 fraction bits). Integer addition is
// associative: any order, any sharding, the same bits. Each term is truncated to a multiple of 2^-64.
#include <cmath>
#include <cstdint>
#include <vector>

namespace ngs {

struct ExactSums {
  std::vector<std::uint64_t> whole, fraction;  // value = whole + fraction · 2^-64

  void resize(std::size_t n) { whole.resize(n, 0), fraction.resize(n, 0); }
  std::size_t size() const { return whole.size(); }
  /// x in [0, 2^63).
  void add(std::size_t i, double x) {
    const double floor_x = std::floor(x);
    add_fixed(i, std::uint64_t(floor_x), std::uint64_t((x - floor_x) * 0x1p64));
  }
  void add(std::size_t i, const ExactSums& other) { add_fixed(i, other.whole[i], other.fraction[i]); }
  /// w + f · 2^-64.
  void add_fixed(std::size_t i, std::uint64_t w, std::uint64_t f) {
    fraction[i] += f;
    whole[i] += w + (fraction[i] < f ? 1 : 0);
  }
  double value(std::size_t i) const { return double(whole[i]) + double(fraction[i]) * 0x1p-64; }
};

}  // namespace ngs
