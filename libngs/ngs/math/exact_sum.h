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
  void add(std::size_t i, double x) { add_fixed(i, whole_of(x), fraction_of(x)); }
  /// An x that was added: nothing of it is left.
  void subtract(std::size_t i, double x) {
    const std::uint64_t f = fraction_of(x);
    whole[i] -= whole_of(x) + (fraction[i] < f ? 1 : 0);
    fraction[i] -= f;
  }
  void add(std::size_t i, const ExactSums& other) { add_fixed(i, other.whole[i], other.fraction[i]); }
  /// w + f · 2^-64.
  void add_fixed(std::size_t i, std::uint64_t w, std::uint64_t f) {
    fraction[i] += f;
    whole[i] += w + (fraction[i] < f ? 1 : 0);
  }
  double value(std::size_t i) const { return double(whole[i]) + double(fraction[i]) * 0x1p-64; }

 private:
  static std::uint64_t whole_of(double x) { return std::uint64_t(std::floor(x)); }
  static std::uint64_t fraction_of(double x) { return std::uint64_t((x - std::floor(x)) * 0x1p64); }
};

}  // namespace ngs
