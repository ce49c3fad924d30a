#pragma once
// Quantiles of a sample: always a value of the sample, never a mean of two.
#include <algorithm>
#include <vector>

namespace ngs {

/// For an even number of values, the upper of the two middle ones. `values` must not be empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The value of rank share · (n - 1), rounded down. `values` must not be empty.
inline double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace ngs
