#pragma once
// The device backends that this executable compares with the CPU: the emulated kernels in three thread orders
// (test_emulated, always run), or the CUDA device (test_parity, skipped without one). All backends run the same cases.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "ngs/ops/device/device_ops.h"

namespace ngs::test {

struct Backend {
  std::string name;
  Exec exec;
  bool same_functions = false;  // exp, log etc. are the CPU's: equal order of operations gives equal bits
  bool ordered = true;          // false: atomic sums
};
const std::vector<Backend>& backends();
/// The same devices with atomic sums, whose bits depend on the order of threads.
const std::vector<Backend>& atomic_backends();

/// Largest |got - want| in units of eps(float) · scale; infinite where a value is not finite.
template <class T>
double worst_ratio(const std::vector<T>& got, const std::vector<T>& want, double scale) {
  if (got.size() != want.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double error = std::abs(double(got[i]) - double(want[i]));
    worst = std::isfinite(error) ? std::max(worst, error) : std::numeric_limits<double>::infinity();
  }
  return worst / (double(std::numeric_limits<float>::epsilon()) * scale);
}

template <class T>
double largest(const std::vector<T>& values) {
  double most = 0;
  for (const T v : values) most = std::max(most, std::abs(double(v)));
  return most;
}

/// Checks a ratio against its bound. With NGS_PARITY_TABLE set, also prints a line of a table.
void check_ratio(const Backend& backend, const std::string& what, double ratio, double bound);

}  // namespace ngs::test
