#pragma once
// The median as a robust scale: a value of the sample, no mean of two.
#include <algorithm>
#include <vector>

namespace ngs {

/// The upper one of the two middle values where their number is even. Not empty.
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ngs
