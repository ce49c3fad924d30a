#pragma once
// The median as a robust scale: always a value of the sample, never a mean of two.
#include <algorithm>
#include <vector>

namespace ngs {

/// For an even number of values, the upper of the two middle ones. `values` must not be empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ngs
