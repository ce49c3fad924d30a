#pragma once
// Random test data from core/rng.h: equal numbers on every compiler and platform.
#include <cstdint>
#include <vector>

#include "ngs/core/rng.h"

namespace ngs::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  double uniform(double lo, double hi) { return lo + (hi - lo) * rng_uniform(seed_, RngStream::kTest, next_++); }
  /// An integer in [0, n).
  std::int64_t below(std::int64_t n) {
    return std::int64_t(rng_bits(seed_, RngStream::kTest, next_++) % std::uint64_t(n));
  }
  template <class T = double>
  std::vector<T> uniform_vector(std::size_t n, double lo, double hi) {
    std::vector<T> v(n);
    for (T& x : v) x = T(uniform(lo, hi));
    return v;
  }

 private:
  std::uint64_t seed_, next_ = 0;
};

}  // namespace ngs::test
