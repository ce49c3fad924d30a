#pragma once
// Sums of non-negative numbers in 128-bit fixed point (64 integer bits, 64 fraction bits). Integer addition is
// associative: any order and any sharding give the same bits. Each term is truncated to a multiple of 2^-64.
#include <cmath>
#include <cstdint>
#include <vector>

#include "ngs/core/hd.h"

namespace ngs {

/// value = whole + fraction · 2^-64.
struct ExactSum {
  std::uint64_t whole = 0, fraction = 0;

  /// x in [0, 2^63).
  NGS_HD static ExactSum of(double x) {
    const double floor = std::floor(x);
    return {std::uint64_t(floor), std::uint64_t((x - floor) * 0x1p64)};
  }
  NGS_HD void add(double x) { add(of(x)); }
  NGS_HD void add(const ExactSum& other) {
    fraction += other.fraction;
    whole += other.whole + (fraction < other.fraction ? 1 : 0);
  }
  /// Removes a term that was added, without a trace. If `other` exceeds the sum, the result is 0.
  void subtract(const ExactSum& other) {
    if (whole < other.whole || (whole == other.whole && fraction < other.fraction)) return void(*this = {});
    whole -= other.whole + (fraction < other.fraction ? 1 : 0);
    fraction -= other.fraction;
  }
  double value() const { return double(whole) + double(fraction) * 0x1p-64; }
  bool operator==(const ExactSum&) const = default;
};

struct ExactSums {
  std::vector<std::uint64_t> whole, fraction;

  void resize(std::size_t n) {
    whole.resize(n, 0);
    fraction.resize(n, 0);
  }
  std::size_t size() const { return whole.size(); }
  ExactSum at(std::size_t i) const { return {whole[i], fraction[i]}; }
  void add(std::size_t i, double x) { add(i, ExactSum::of(x)); }
  void add(std::size_t i, const ExactSum& other) {
    ExactSum sum = at(i);
    sum.add(other);
    set(i, sum);
  }
  void subtract(std::size_t i, double x) {
    ExactSum sum = at(i);
    sum.subtract(ExactSum::of(x));
    set(i, sum);
  }
  double value(std::size_t i) const { return at(i).value(); }

 private:
  void set(std::size_t i, const ExactSum& sum) {
    whole[i] = sum.whole;
    fraction[i] = sum.fraction;
  }
};

}  // namespace ngs
