#pragma once
// LAPACK-style test ratios: error / (error that rounding alone explains). A ratio near 1 is as good as the arithmetic
// allows. Each test measures its budget and pins it.
#include <algorithm>
#include <cmath>
#include <limits>

namespace ngs::test {

/// |got - want| / (eps(T) · condition · |want|). NaN and Inf count as infinitely wrong.
template <class T>
double ratio(T got, double want, double condition = 1.0) {
  if (!std::isfinite(double(got))) return std::numeric_limits<double>::infinity();
  const double allowed = double(std::numeric_limits<T>::epsilon()) * condition * std::abs(want);
  return std::abs(double(got) - want) / std::max(allowed, double(std::numeric_limits<T>::min()));
}

}  // namespace ngs::test
